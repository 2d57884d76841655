# Edit   What was measured of the folding door is lost.
# Loses  folding_door,stretch,position,0.996019,0.98,m
PREFIX id: <https://example.org/id/>
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?diagnosis law:value ?value } }
WHERE { GRAPH ?graph { ?verdict law:container id:a\/body\/folding_door ; law:diagnosis ?diagnosis . ?diagnosis law:value ?value } }
