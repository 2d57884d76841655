# Edit   A certified verdict loses what CanPerform said.
PREFIX id: <https://example.org/id/>
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?verdict law:canPerform true } }
WHERE { GRAPH ?graph { ?verdict law:canPerform true ; law:outcome law:Certified ; law:robot id:pr2 ; law:container id:a\/body\/low_drawer } }
