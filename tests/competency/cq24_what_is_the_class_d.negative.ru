# Edit   Open begins at 0.8 of the way.
# Loses  D_artic,openFraction,0.9
# Gains  D_artic,openFraction,0.8
PREFIX tee: <https://example.org/tee#>

DELETE { GRAPH ?graph { tee:D_artic tee:openFraction ?share } }
INSERT { GRAPH ?graph { tee:D_artic tee:openFraction 0.8 } }
WHERE { GRAPH ?graph { tee:D_artic tee:openFraction ?share } }
