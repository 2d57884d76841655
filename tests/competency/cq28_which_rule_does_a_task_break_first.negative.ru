# Edit   The bound of the rule is said to have been another one.
# Loses  "top drawer, never beyond 0.3",top_drawer never beyond 0.3,top_drawer,2.77373,0.304282,0.3
# Gains  "top drawer, never beyond 0.3",top_drawer never beyond 0.3,top_drawer,2.77373,0.304282,0.4
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?diagnosis law:bound ?bound } }
INSERT { GRAPH ?graph { ?diagnosis law:bound 0.4 } }
WHERE { GRAPH ?graph { ?rule a law:RuleAnswer ; law:diagnosis ?diagnosis . ?diagnosis law:bound ?bound } }
