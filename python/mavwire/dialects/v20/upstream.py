"""MAVLink dialect upstream, laid out for wire protocol 2.0; see mavwire.dialects."""

from mavwire.dialects import populate_builtin

populate_builtin(globals())
