"""Dataflash and CSV logs; `mavwire.DFReader` and `mavwire.CSVReader` are the faces of it."""
