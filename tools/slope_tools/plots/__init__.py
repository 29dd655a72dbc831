"""Pictures of results: charts, sheets, maps, sections."""
