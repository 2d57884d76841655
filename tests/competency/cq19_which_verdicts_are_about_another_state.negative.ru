# Edit   The drawer stood a little further out.
# Loses  pr2,Close,oven_door,top_drawer_joint,0.25
# Loses  pr2,Close,top_drawer,top_drawer_joint,0.25
# Loses  stretch,Close,oven_door,top_drawer_joint,0.25
# Loses  stretch,Close,top_drawer,top_drawer_joint,0.25
# Gains  pr2,Close,oven_door,top_drawer_joint,0.3
# Gains  pr2,Close,top_drawer,top_drawer_joint,0.3
# Gains  stretch,Close,oven_door,top_drawer_joint,0.3
# Gains  stretch,Close,top_drawer,top_drawer_joint,0.3
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?at law:value 0.25e0 } }
INSERT { GRAPH ?graph { ?at law:value 0.3e0 } }
WHERE { GRAPH ?graph { ?at a law:JointPosition ; law:value 0.25e0 } }
