"""MAVLink dialect upstream, laid out for wire protocol 1.0; see mavwire.dialects."""

from mavwire.dialects import populate_builtin

populate_builtin(globals())
