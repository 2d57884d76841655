# Edit   A refusal loses its reasons.
PREFIX id: <https://example.org/id/>
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?verdict law:diagnosis ?diagnosis } }
WHERE { GRAPH ?graph { ?verdict law:diagnosis ?diagnosis ; law:robot id:stretch ; law:container id:a\/body\/high_drawer } }
