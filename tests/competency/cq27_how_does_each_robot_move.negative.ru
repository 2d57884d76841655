# Edit   Stretch moves as its hardware does.
# Loses  stretch,Omni,0.2,0.2,1
# Gains  stretch,Differential,0.2,0.2,1
PREFIX id: <https://example.org/id/>
PREFIX sdt: <https://example.org/sdt#>

DELETE { GRAPH ?graph { id:stretch sdt:drive ?drive } }
INSERT { GRAPH ?graph { id:stretch sdt:drive sdt:Differential } }
WHERE { GRAPH ?graph { id:stretch sdt:drive ?drive } }
