# Edit   Stretch was asked about with another drive in kitchen b.
# Gains  Close,embodiment.drive,2
# Gains  Open,embodiment.drive,2
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
