# Edit   About the swing door there is a refusal, not an abstention.
# Loses  a,swing_door,effectiveLowerLimit,-1,0
# Loses  a,swing_door,lowerLimit,-1,0
PREFIX law: <https://example.org/law#>

DELETE { GRAPH ?graph { ?verdict law:outcome law:Abstained } }
INSERT { GRAPH ?graph { ?verdict law:outcome law:NotCertified } }
WHERE { GRAPH ?graph { ?verdict law:outcome law:Abstained } }
