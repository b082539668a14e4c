"""Arrow's kinds of columns: those of other libraries as those that tables of logs have."""

from __future__ import annotations

from typing import Any

from mavwire._extras import extra

OWN = ("Timestamp(µs", "Dictionary(Int32, Utf8)")
OTHERS = ("Timestamp(", "Dictionary(", "Utf8View", "LargeUtf8", "BinaryView", "LargeBinary")


def foreign(kind: str) -> bool:
    """Whether `conformed` has to check a column of a type in `Table.dtypes`."""
    return (kind.startswith(OTHERS) and not kind.startswith(OWN)) or "FixedSizeList" in kind


def conformed(table: Any) -> Any:
    """A pyarrow table of an Arrow stream, with times, texts and categories of the types of mavwire.
    ValueError for values that these types do not hold.
    """
    with extra("data"):
        import pyarrow as pa
        import pyarrow.compute as pc

    table = pa.table(table)
    for place, field in enumerate(table.schema):
        column, kind = table.column(place), _own_kind(field.type)
        if pa.types.is_fixed_size_list(kind) and pc.list_flatten(column).null_count:
            raise ValueError(f"column {field.name!r} has lists in which values are missing")
        if kind == field.type:
            continue
        try:
            if pa.types.is_dictionary(field.type):
                column = _keyed(column)
            column = pc.cast(column, options=pc.CastOptions(kind, allow_time_truncate=True))
        except pa.ArrowInvalid as error:
            raise ValueError(f"column {field.name!r}: {error}") from None
        table = table.set_column(place, field.with_type(kind), column)
    return table


def _keyed(column: Any) -> Any:
    """A dictionary column with keys and values of our kinds."""
    with extra("data"):
        import pyarrow as pa

    kind = pa.dictionary(pa.int32(), _own_kind(column.type.value_type))
    chunks = [
        pa.DictionaryArray.from_arrays(
            one.indices.cast(kind.index_type), one.dictionary.cast(kind.value_type)
        )
        for one in column.chunks
    ]
    return pa.chunked_array(chunks, kind)


def _own_kind(kind: Any) -> Any:
    """The type of mavwire for an Arrow type, which may be the same."""
    with extra("data"):
        import pyarrow as pa

    if pa.types.is_timestamp(kind):
        return pa.timestamp("us", kind.tz)
    if pa.types.is_large_string(kind) or pa.types.is_string_view(kind):
        return pa.string()
    if pa.types.is_large_binary(kind) or pa.types.is_binary_view(kind):
        return pa.binary()
    if pa.types.is_dictionary(kind):
        values = _own_kind(kind.value_type)
        return pa.dictionary(pa.int32(), values) if pa.types.is_string(values) else values
    return kind
