# Edit   Verdicts that are not certified count for nothing, whatever they kept of a motion.
# Loses  pr2,Open,folding_door,3.24748
# Loses  pr2,Open,high_drawer,4.67155
# Loses  pr2,Open,low_drawer,4.67155
# Loses  pr2,Open,side_door,6.32669
# Loses  stretch,Open,low_drawer,4.67155
# Loses  stretch,Open,side_door,6.32669
PREFIX id: <https://example.org/id/>
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?verdict law:outcome law:Certified } }
INSERT { GRAPH ?graph { ?verdict law:outcome law:NotCertified } }
WHERE { GRAPH ?graph { ?verdict law:outcome law:Certified ; law:environment id:a } }
