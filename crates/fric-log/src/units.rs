//! Units in the heads of columns, as people and programs write them.
//!
//! A head is the name of a column: `Kraft [kN]`, `Weg (mm)`, `v/(mm/s)`, `force_n`. The first letter of a unit tells milli from mega (`mN`, `MN`);
//! otherwise upper and lower case are the same.

/// A quantity of the signals of a cable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Time, s.
    Time,
    /// Force, N. The units of mass stand for its weight.
    Force,
    /// Length, m.
    Length,
    /// Speed, m/s.
    Speed,
}

/// What a unit says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unit {
    /// One of a signal, with the factor to s, N, m or m/s.
    Of(Quantity, f64),
    /// One of something else, such as a torque or an angle.
    Other,
}

/// Standard gravity, m/s².
const GRAVITY: f64 = 9.80665;

/// Units of the signals. Of two that differ in upper and lower case alone the first stands for other spellings.
const UNITS: [(&str, Quantity, f64); 47] = [
    ("s", Quantity::Time, 1.0),
    ("sec", Quantity::Time, 1.0),
    ("seconds", Quantity::Time, 1.0),
    ("sekunden", Quantity::Time, 1.0),
    ("ms", Quantity::Time, 1e-3),
    ("milliseconds", Quantity::Time, 1e-3),
    ("millisekunden", Quantity::Time, 1e-3),
    ("us", Quantity::Time, 1e-6),
    ("µs", Quantity::Time, 1e-6),
    ("μs", Quantity::Time, 1e-6),
    ("ns", Quantity::Time, 1e-9),
    ("N", Quantity::Force, 1.0),
    ("newton", Quantity::Force, 1.0),
    ("newtons", Quantity::Force, 1.0),
    ("daN", Quantity::Force, 10.0),
    ("kN", Quantity::Force, 1e3),
    ("kilonewton", Quantity::Force, 1e3),
    ("mN", Quantity::Force, 1e-3),
    ("MN", Quantity::Force, 1e6),
    ("kg", Quantity::Force, GRAVITY),
    ("kgf", Quantity::Force, GRAVITY),
    ("kp", Quantity::Force, GRAVITY),
    ("g", Quantity::Force, 1e-3 * GRAVITY),
    (TONNE, Quantity::Force, 1e3 * GRAVITY),
    ("lbf", Quantity::Force, 4.448_221_615_260_5),
    ("m", Quantity::Length, 1.0),
    ("meter", Quantity::Length, 1.0),
    ("metre", Quantity::Length, 1.0),
    ("metres", Quantity::Length, 1.0),
    ("cm", Quantity::Length, 1e-2),
    ("mm", Quantity::Length, 1e-3),
    ("millimeter", Quantity::Length, 1e-3),
    ("millimetre", Quantity::Length, 1e-3),
    ("millimetres", Quantity::Length, 1e-3),
    ("um", Quantity::Length, 1e-6),
    ("µm", Quantity::Length, 1e-6),
    ("μm", Quantity::Length, 1e-6),
    ("m/s", Quantity::Speed, 1.0),
    ("cm/s", Quantity::Speed, 1e-2),
    ("mm/s", Quantity::Speed, 1e-3),
    ("m/min", Quantity::Speed, 1.0 / 60.0),
    ("m_per_s", Quantity::Speed, 1.0),
    ("m_s", Quantity::Speed, 1.0),
    ("mps", Quantity::Speed, 1.0),
    ("cm_s", Quantity::Speed, 1e-2),
    ("mm_s", Quantity::Speed, 1e-3),
    ("mm_per_s", Quantity::Speed, 1e-3),
];
/// It is also the symbol of time: `delta_t` and `log/t` have no unit.
const TONNE: &str = "t";

/// Units of what is none of the signals.
const OTHER_UNITS: [&str; 30] = [
    "nm", "n·m", "n m", "ncm", "rev", "rpm", "1/min", "u/min", "deg", "°", "rad", "deg/s", "°/s", "rad/s", "deg_s",
    "rad_s", "v", "mv", "mv/v", "a", "ma", "w", "°c", "k", "%", "hz", "bar", "pa", "counts", "inc",
];
/// Stand for no unit.
const NO_UNIT: [&str; 3] = ["", "-", "1"];

impl Unit {
    /// Returns the meaning of a unit; `None` if it is not known.
    #[must_use]
    pub fn of(symbol: &str) -> Option<Self> {
        let exact = UNITS.iter().find(|(of, ..)| *of == symbol);
        let lower = symbol.to_lowercase();
        let known = exact.or_else(|| UNITS.iter().find(|(of, ..)| of.to_lowercase() == lower));
        match known {
            Some((_, quantity, factor)) => Some(Self::Of(*quantity, *factor)),
            None => OTHER_UNITS.contains(&lower.as_str()).then_some(Self::Other),
        }
    }

    /// Whether values in it need a factor, or are of something else. A torque is in newton metres.
    #[must_use]
    pub(crate) fn is_other_than_ours(self, symbol: &str) -> bool {
        match self {
            Self::Of(_, factor) => factor.to_bits() != 1.0_f64.to_bits(),
            Self::Other => !symbol.eq_ignore_ascii_case("nm"),
        }
    }
}

/// The name of a column without its unit, and the unit as it is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Head<'a> {
    /// The name.
    pub name: &'a str,
    /// The unit in brackets, behind a slash or behind an underscore.
    pub unit: Option<&'a str>,
}

impl<'a> Head<'a> {
    /// Takes the name of a column apart. What stands in brackets counts as a unit even if it is not known.
    #[must_use]
    pub fn of(column: &'a str) -> Self {
        let column = column.trim();
        // `kN` is a unit without a name, while `s` or `N` may be a name.
        if column.chars().count() > 1 && Unit::of(column).is_some() {
            return Self { name: "", unit: Some(column) };
        }
        let bracketed = || {
            let open = column.find(['[', '('])?;
            let inside = column.get(open + 1..)?.split([']', ')']).next()?;
            Some(Self { name: column.get(..open)?, unit: Some(inside.trim()) })
        };
        let behind = |sign: char, is_unit: &dyn Fn(&str) -> bool| {
            let split = |(place, _)| Some((column.get(..place)?, column.get(place + sign.len_utf8()..)?.trim()));
            let mut halves = column.match_indices(sign).filter_map(split);
            halves.find(|(_, unit)| is_unit(unit)).map(|(name, unit)| Self { name, unit: Some(unit) })
        };
        let is_of_signal = |unit: &str| unit != TONNE && matches!(Unit::of(unit), Some(Unit::Of(..)));
        // `rig/v` may be a speed.
        let is_divisor = |unit: &str| is_of_signal(unit) || unit.len() > 1 && Unit::of(unit).is_some();
        // The second word of `rad_s` alone is a unit of time.
        let is_end = |unit: &str| is_of_signal(unit) || unit.contains('_') && Unit::of(unit).is_some();
        bracketed()
            .or_else(|| behind('/', &is_divisor))
            .or_else(|| behind('_', &is_end))
            .unwrap_or(Self { name: column, unit: None })
    }
}

/// Returns a cell of a line of units without brackets; `None` if it states no unit.
#[must_use]
pub fn stated_unit(cell: &str) -> Option<&str> {
    Some(cell.trim_matches(['[', ']', '(', ')', ' '])).filter(|unit| !NO_UNIT.contains(unit))
}

/// Whether the cells of a line are units: at least half of those that are filled.
pub(crate) fn are_units(cells: &[String]) -> bool {
    let filled = cells.iter().filter(|cell| !cell.is_empty()).count();
    let units = cells.iter().filter_map(|cell| stated_unit(cell)).filter(|unit| Unit::of(unit).is_some()).count();
    let without = cells.iter().filter(|cell| !cell.is_empty() && stated_unit(cell).is_none()).count();
    units > 0 && 2 * (units + without) >= filled
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_letter_tells_milli_from_mega() {
        for (symbol, factor) in [
            ("MN", 1e6),
            ("mN", 1e-3),
            ("mn", 1e-3),
            ("KN", 1e3),
            ("daN", 10.0),
            ("kp", 9.80665),
            ("kgf", 9.80665),
            ("t", 9806.65),
            ("n", 1.0),
        ] {
            let Some(Unit::Of(Quantity::Force, found)) = Unit::of(symbol) else { panic!("{symbol}") };
            assert!((found / factor - 1.0).abs() < 1e-12, "{symbol}: {found}");
        }
        assert_eq!(Unit::of("MM"), Some(Unit::Of(Quantity::Length, 1e-3)));
        assert_eq!([Unit::of("Nm"), Unit::of("xy")], [Some(Unit::Other), None]);
    }

    #[test]
    fn a_head_is_taken_apart() {
        for (column, name, unit) in [
            ("Kraft Winde [kN]", "Kraft Winde ", Some("kN")),
            ("F_Winde/kN", "F_Winde", Some("kN")),
            ("l/mm", "l", Some("mm")),
            ("v/(mm/s)", "v/", Some("mm/s")),
            ("v / mm/s", "v ", Some("mm/s")),
            ("Winde 1/Kraft/kN", "Winde 1/Kraft", Some("kN")),
            ("speed_2_mm_per_s", "speed_2", Some("mm_per_s")),
            ("F_MN", "F", Some("MN")),
            ("speed_m_s", "speed", Some("m_s")),
            ("motor_rad_s", "motor", Some("rad_s")),
            ("run_time_s", "run_time", Some("s")),
            ("/joint/position", "/joint/position", None),
            ("delta_t", "delta_t", None),
            ("rig/v", "rig/v", None),
            ("M/Nm", "M", Some("Nm")),
            ("ms", "", Some("ms")),
            ("s", "s", None),
            ("Kraft [xy]", "Kraft ", Some("xy")),
        ] {
            assert_eq!(Head::of(column), Head { name, unit }, "{column}");
        }
    }

    #[test]
    fn a_line_of_units_has_more_units_than_names() {
        let are = |cells: &[&str]| are_units(&cells.iter().map(|cell| (*cell).to_owned()).collect::<Vec<_>>());
        assert!(are(&["s", "N", "mm"]) && are(&["", "[kN]", "(mm)", "-", ""]) && are(&["ms", "kN", "Skt", "V"]));
        assert!(!are(&["ms", "Servo motor speed", "Torque", "INP"]) && !are(&["Zeit", "-", "Weg"]) && !are(&["", ""]));
    }
}
