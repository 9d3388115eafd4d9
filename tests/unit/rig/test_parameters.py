from hypothesis import given
from hypothesis import strategies as st

from fprc.rig.parameters import record

NAMES = st.from_regex(r"[a-z]{1,8}", fullmatch=True)
NUMBERS = st.floats(-1e6, 1e6) | st.integers(-1000, 1000)
LEAVES = NUMBERS | st.lists(NUMBERS, min_size=2, max_size=4)
NESTED = st.recursive(
    st.dictionaries(NAMES, LEAVES, min_size=1, max_size=4),
    lambda inner: st.dictionaries(NAMES, LEAVES | inner, min_size=1, max_size=4),
    max_leaves=8,
)


def unpack(packed):
    if packed.dtype.names:
        return {name: unpack(packed[name]) for name in packed.dtype.names}
    return packed.tolist()


@given(NESTED)
def test_record_holds_every_name_in_order_and_every_value(values):
    packed = record(values)
    assert packed.shape == (1,)
    unpacked = unpack(packed[0])
    assert unpacked == values
    assert list(unpacked) == list(values)
