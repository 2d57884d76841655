# Edit   Stretch was asked about with another drive in kitchen b.
# Gains  oven_door,Close,embodiment.drive
# Gains  oven_door,Open,embodiment.drive
# Gains  top_drawer,Close,embodiment.drive
# Gains  top_drawer,Open,embodiment.drive
PREFIX id: <https://example.org/id/>
PREFIX law: <https://example.org/law#>
PREFIX prov: <http://www.w3.org/ns/prov#>

DELETE { GRAPH ?graph { ?input law:inputHash ?drive } }
INSERT { GRAPH ?graph { ?input law:inputHash "fixed" } }
WHERE {
  GRAPH ?graph {
    ?verdict law:environment id:b ;
      law:robot id:stretch ;
      prov:wasGeneratedBy/prov:used ?input .
    ?input law:inputHash ?drive ;
      law:name "embodiment.drive" .
  }
}
