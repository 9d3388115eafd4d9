"""What the name of a column says: its unit, its quantity, its channel."""

import re
import unicodedata
from contextlib import suppress
from functools import cache
from typing import NamedTuple

from fprc.channels import RAW_CHANNELS

#: Units of time in s, coarsest first.
SECONDS = {"d": 86400.0, "h": 3600.0, "min": 60.0, "s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
#: Units as people write them, in lower case, by how pint reads them.
_SPELLINGS = {
    word: unit
    for unit, words in {
        **{unit: unit.lower() for unit in (
            "Pa kPa MPa hPa bar mbar psi torr mmHg cmH2O inHg atm mrad mV N mm mA rpm Hz ohm "
            "rad/s").split()},
        "d": "d day days tag tage jour jours 日数",
        "h": "h hr hrs hour hours std stunde stunden heure heures horas ore uren",
        "min": "min mins minute minutes minuten minutos minuti 分",
        "s": "s sec secs second seconds sek sekunden secondes segundos secondi seconden 秒",
        "ms": "ms msec millis millisecond milliseconds millisekunde millisekunden ミリ秒 毫秒",
        "us": "us usec micros microsecond microseconds mikrosekunde mikrosekunden マイクロ秒 微秒",
        "ns": "ns nsec nsecs nanosec nanosecond nanoseconds nanos 纳秒",
        "deg": "deg degs degree degrees grad grado gradi grados degre degres graden 度 °",
        "rad": "rad rads radian radians 弧度 ラジアン",
        "kgf/cm**2": "kgf/cm2 kg/cm2", "N/mm**2": "n/mm2", "N/m**2": "n/m2", "V": "v volt volts",
        "N*m": "nm", "degC": "degc °c", "L/min": "l/min lpm", "deg/s": "deg/s °/s",
    }.items()
    for word in words.split()
}  # fmt: skip
#: Of these, what is a unit without brackets too.
_BARE = frozenset(_SPELLINGS) - set("n grad pa s h d min std ore tag second".split())
#: Words for units of time, which the name of a clock may have.
TIMES = frozenset(word for word, unit in _SPELLINGS.items() if unit in SECONDS)
_REFERENCE = r"(?i)\b(?:abs(?:olute?)?|rel(?:ative?)?|gau?ge)\b\.?|\((?:g|a|abs|rel)\)"
#: Units of pressure that say in their last letter whether they are gauge or absolute.
_GAUGE = r"(bar|psi|kpa|mbar)[ag]$"
#: Words in names of columns, in English, German, French, Spanish, Italian, Dutch, Japanese and
#: Chinese. ``~`` is the rest of a compound.
_WORDS = {
    "time": "t|~time|~stamp|date|clock|elapsed|x_value|~zeit|zeitstempel|datum|temps|heure|tiempo|"
    "fecha|hora|tempo|ora|~tijd|tijdstempel|~時間~|~時刻~|~日時~|~时间~|~时刻~|~日期~",
    "count": "samples?|index|idx|count|counter|seq|row|nr|no|id|n|i|number|frame|record|nummer|"
    "zeile|numero|ligne|fila|riga|nombre|サンプル|番号|序号|编号",
    "angle": "theta~|θ|~angles?|bend|bending|~winkel|~biegung|flexion|inclinaison|angulo|doblado|"
    "angolo|piegatura|flessione|~hoek|buiging|~角度~|~屈曲~|~曲げ角~|~弯曲~|~彎曲~|~转角~",
    "pressure": "~pressure~|press|p_?exp|~druck~|pression~|presion~|~druk~|~圧力~|~圧|~压力~|"
    "~壓力~|~压强~|~气压~",
    "command": "command|commanded|cmd|set|setpoint|desired|demand|soll~|vorgabe~|consigne|commande|"
    "consigna|comando|impostata|gewenste?|instelwaarde|~指令~|~目標~|~設定~|~目标~|~设定~|~给定~|"
    "~期望~",
    "wanted": "theta_?d|ref|referen[cz]~|target|error|erreur|riferimento|偏差|误差",
    "sealed": "p_?o|p_?res|pam_?b|sealed|reservoir|versiegelt~|verschlossen~|geschlossen~|scellee?|"
    "etanche|fermee?|sellad[ao]|cerrad[ao]|sigillat[ao]|chius[ao]|afgesloten|~密閉~|~リザーバ~|"
    "~密封~|~储层~|~封闭~",
    "chamber": "~chamber|~kammer~|chambre|reservoir|camara|camera|~kamer~|~チャンバ~|~室~|~腔~",
    "inner": "p_?i|pam_?a",
    "phi": "phi|φ",
    "sensor": "~sensor[es]?|strain|stretch|capacitance|capteur|dehnung~|ひずみ|~センサ~|~传感器~",
    "other": "current|strom|courant|corriente|corrente|stroom|force|kraft|fuerza|forza|kracht|"
    "moment~|torque|drehmoment|couple|temperature?|temp|speed|vel|velocity|rate|omega|accel~|~dot|"
    "flow|durchfluss|debit|voltage|spannung|memory|power|energy|status|電流|~力矩~|トルク|速度|"
    "温度|电流|電圧|电压|流量|~角速度~",
    "absolute": "abs|absolut~|absolu|assolut~|(?:m?bar|psi|kpa)_?a|~絶対~|~绝对~",
    "gauge": "gau?ge|rel|relati[fv]e?|ue?berdruck|(?:m?bar|psi|kpa)_?g|~ゲージ~|~表压~",
}
#: Those of Japanese and Chinese, which tell the encoding of a text.
KANJI = re.findall(r"[\u3000-\u9fff]{2,}", "|".join(_WORDS.values()))


class Unit(NamedTuple):
    """A unit that a name holds."""

    text: str  #: as a map writes it
    quantity: str  #: the unit of the channels that it converts to, or another quantity
    factor: float  #: to that unit
    multiple: float = 1.0  #: the number beside it, as in ``[0.1 bar]``


@cache
def parse_unit(text: str) -> Unit | None:
    """Return the unit that a text is, perhaps with a factor; None if it is none."""
    import pint  # slow

    text = re.sub(_REFERENCE, "", unicodedata.normalize("NFKC", text).replace("μ", "u")).strip()
    plain = re.sub(_GAUGE, r"\1", text.lower())
    multiple = re.match(r"[x×*]?\s*(\d[\d.]*(?:e[+-]?\d+|\^[+-]?\d+)?)\s*[x×*]?\s*(\D.*)", text)
    if multiple and (inner := parse_unit(multiple[2])):
        base, _, power = multiple[1].partition("^")
        return inner._replace(multiple=float(base) ** float(power or 1))
    known = _SPELLINGS.get(plain.replace("^", "").replace("·", ""))
    if known in SECONDS:
        return Unit(known, "s", SECONDS[known])
    for spelled in [known] if known else [text, plain]:
        if re.fullmatch(r"[A-Za-z°%][\w°%/*^ .-]*", spelled):
            with suppress(Exception):  # pint raises many types
                one = pint.application_registry.Quantity(1.0, spelled.replace("^", "**"))
                # for pint, angles have no dimension
                angle = str(one.units).endswith(("degree", "radian", "arcminute", "turn"))
                for quantity in ("deg",) if angle else ("kPa", "V"):
                    if one.is_compatible_with(quantity):
                        return Unit(spelled, quantity, float(one.to(quantity).magnitude))
                return Unit(spelled, str(one.units), 1.0)
    return None


def is_unit(text: str) -> bool:
    """Return whether a text is a unit, in brackets or not; of single letters only usual ones."""
    plain = text.strip("[](){} ")
    usual = len(plain) > 1 or plain in "shdVANm°%K" or plain != text
    return plain == "-" or (usual and parse_unit(plain) is not None)


@cache
def unit_in(name: str, bare: frozenset[str] = _BARE) -> Unit | None:
    """Return the unit in a name: in the bracket at its end, or its last word that is one."""
    name = unicodedata.normalize("NFKC", name).replace("μ", "u").strip()
    bracket = re.search(r"[\[({<]([^\[\](){}<>]*(?:\([a-z]+\))?)[\])}>]$", name)
    if bracket and (unit := parse_unit(bracket[1])):
        return unit
    words = re.findall(r"[^\W\d_]+(?:/(?:s|min|[cm]?m2)\b)?\d*|[°%]", re.sub(_REFERENCE, "", name))
    for word in reversed(words):
        humps = re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\W", word)
        for part in (word, "".join(humps[-2:]), "".join(humps[-1:])):
            # PA and MA may be ports, and p_a a part of a name
            known = re.sub(_GAUGE, r"\1", part.lower()) in bare and part not in ("MA", "MM", "NM")
            if part == "Pa" or known:
                return parse_unit(part)
    return None


def stated_unit(name: str, label: str, unit: str) -> Unit | None:
    """Return the unit that a file states for a column, beside its name or in it."""
    return parse_unit(unit) or unit_in(label) or unit_in(name)


def factor_of(unit: str, quantity: str) -> float | None:
    """Return the factor from a unit to that of a channel; None if it is of another quantity."""
    if unit == "1":
        return 1.0
    found = parse_unit(unit)
    return found.factor * found.multiple if found and found.quantity == quantity else None


def is_time(name: str) -> bool:
    """Return whether a name says that the column holds times."""
    inside = unit_in(name)
    return inside.quantity == "s" if inside else has(name, "time")


@cache
def has(name: str, what: str) -> bool:
    """Return whether a name has one of the words for something; bendAngle are two words."""
    separate = re.sub(r"[\W_]+", "_", re.sub(r"(?<=[a-z])(?=[A-Z][a-z])", "_", name))
    plain, words = (
        "".join(c for c in unicodedata.normalize("NFKD", text) if not unicodedata.combining(c))
        for text in (separate.lower(), _WORDS[what].replace("~", r"[^\W_]*"))
    )
    return bool(re.search(rf"(?<![^\W_])(?:{words})(?![^\W_])", plain))


def likely_channel(name: str, label: str = "", unit: str = "") -> tuple[str, int] | None:
    """Guess the channel of a column; None if none fits, as with a unit of another quantity.

    How sure it is: 4, it is the channel's name; 3, word and unit; 2, a word; 1, the unit.
    """
    if name in RAW_CHANNELS[1:]:
        return name, 4
    words, stated = f"{name} {label}", stated_unit(name, label, unit)
    quantity = stated.quantity if stated else ""
    if quantity not in ("", "kPa", "deg") or (not stated and has(words, "other")):
        return None
    command, wanted = has(words, "command"), has(words, "wanted")
    pressure = bool(quantity) or has(words, "pressure")
    named = True  # whether a word names it, and not the unit alone
    if quantity != "kPa" and has(words, "phi"):
        channel = "phi_deg"
    elif quantity == "deg" or (not quantity and has(words, "angle")):
        channel, named = "theta_deg", has(words, "angle")
        if wanted or (named and command):
            return None
    elif has(words, "inner"):
        channel = "p_i_command_kpa" if command else "p_i_kpa"
    elif has(words, "sealed") or (pressure and has(words, "chamber") and not command):
        channel = "p_o_kpa"
    elif command:
        channel = "p_exp_command_kpa"
    elif wanted or not pressure:
        return None
    else:
        channel, named = "p_exp_kpa", has(words, "pressure")
    return channel, 2 * named + (stated is not None)
