"""Settings that are not typed each time: flags over environment (`SDT_…`) over one TOML file."""
