# Edit   A task that breaks a rule is called certified.
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?result law:taskOutcome law:NotCertified } }
INSERT { GRAPH ?graph { ?result law:taskOutcome law:Certified } }
WHERE { GRAPH ?graph { ?result a law:TaskResult ; law:taskOutcome law:NotCertified } }
