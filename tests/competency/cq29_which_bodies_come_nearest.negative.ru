# Edit   At the low drawer it is a finger of the stretch that comes so near to its base.
# Loses  stretch,low_drawer,0.0145,base,carriage,1.25
# Gains  stretch,low_drawer,0.0145,base,left_finger,1.25
PREFIX id: <https://example.org/id/>
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?figure law:link id:stretch\/body\/carriage } }
INSERT { GRAPH ?graph { ?figure law:link id:stretch\/body\/left_finger } }
WHERE { GRAPH ?graph { ?verdict law:container id:a\/body\/low_drawer ; law:figure ?figure . ?figure law:link id:stretch\/body\/carriage } }
