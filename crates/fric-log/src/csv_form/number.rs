//! Parses numbers and times as people and programs write them.

use jiff::Timestamp;
use jiff::civil::{DateTime, Time};
use jiff::tz::TimeZone;

/// Dates that ISO 8601 does not have. With slashes, the day may come before the month or after it, unless the year comes first.
const DATES: [&str; 2] = ["%d.%m.%Y %H:%M:%S%.f", "%Y/%m/%d %H:%M:%S%.f"];

/// What programs write where there is no value, beside an empty cell and `nan`: spreadsheets, pandas and R, the C library of Windows, and loggers.
const NO_VALUE: [&str; 15] = [
    "-", "--", "---", "na", "n/a", "#n/a", "#nv", "n.a.", "n.v.", "k.a.", "null", "none", "1.#qnan", "-1.#ind",
    "1.#ind",
];

/// Whether a cell says in words that there is no value. The form of a file is found without them: a header or a line of units may have a `-` too.
pub fn is_without_value(cell: &str) -> bool {
    NO_VALUE.iter().any(|word| cell.eq_ignore_ascii_case(word))
}

/// The decimal separator of a file, which is either a point or a comma throughout.
#[derive(Debug, Clone, Copy, Default)]
pub struct Decimals {
    has_points: bool,
    has_commas: bool,
}

impl Decimals {
    /// Returns the number in a cell; NaN if it is empty or says so. `None` if it is not a number, or if commas and points are mixed.
    pub fn number(&mut self, cell: &str) -> Option<f64> {
        if cell.is_empty() {
            return Some(f64::NAN);
        }
        // A rejected number says nothing about the file.
        if cell.contains(',') {
            let is_one = !self.has_points && !cell.contains('.') && cell.matches(',').count() == 1;
            let number = cell.replace(',', ".").parse().ok().filter(|_| is_one)?;
            self.has_commas = true;
            return Some(number);
        }
        let has_point = cell.contains('.');
        let number = cell.parse().ok().filter(|_| !(has_point && self.has_commas))?;
        self.has_points |= has_point;
        Some(number)
    }
}

/// Returns the nanoseconds since 1970 of a date with a time of day, or since midnight of a time of day alone; `None` if it is neither. Without an offset
/// from UTC it is taken for UTC.
pub fn clock_nanos(cell: &str) -> Option<i64> {
    // Decided quickly for numbers.
    if !cell.contains(':') {
        return None;
    }
    let cell = cell.replace(',', ".");
    let since_1970 = |date: DateTime| TimeZone::UTC.to_timestamp(date).ok();
    let written = |form: &str| DateTime::strptime(form, &cell).ok();
    let stamp = cell.parse::<Timestamp>().ok();
    let stamp = stamp.or_else(|| cell.parse().ok().and_then(since_1970));
    let stamp = stamp.or_else(|| DATES.iter().copied().find_map(written).and_then(since_1970));
    match stamp {
        Some(stamp) => i64::try_from(stamp.as_nanosecond()).ok(),
        None => Some(cell.parse::<Time>().ok()?.duration_since(Time::midnight()).as_nanos())
            .and_then(|nanos| i64::try_from(nanos).ok()),
    }
}

/// Returns a decimal number times `10^exponent`, exactly, rounded to an integer; `None` if it is not written in plain digits.
pub fn scaled(cell: &str, exponent: u32) -> Option<i64> {
    let (is_negative, digits) = match cell.strip_prefix('-') {
        Some(digits) => (true, digits),
        None => (false, cell.strip_prefix('+').unwrap_or(cell)),
    };
    let (whole, fraction) = digits.split_once(['.', ',']).unwrap_or((digits, ""));
    let is_plain = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    if whole.is_empty() && fraction.is_empty() || !is_plain(whole) || !is_plain(fraction) {
        return None;
    }
    let mut value: i128 = if whole.is_empty() { 0 } else { whole.parse().ok()? };
    let mut digits = fraction.bytes().map(|byte| i128::from(byte - b'0'));
    for _ in 0..exponent {
        value = value.checked_mul(10)?.checked_add(digits.next().unwrap_or(0))?;
    }
    if digits.next() >= Some(5) {
        value += 1;
    }
    i64::try_from(if is_negative { -value } else { value }).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_exact_to_the_nanosecond() {
        assert_eq!(scaled("1700000000.123456789", 9), Some(1_700_000_000_123_456_789));
        assert_eq!(scaled("-0,0005", 9), Some(-500_000));
        assert_eq!(scaled("12", 6), Some(12_000_000));
        assert_eq!(scaled("0.0000000015", 9), Some(2));
        assert_eq!(scaled("1700000000123456789", 0), Some(1_700_000_000_123_456_789));
        assert_eq!([scaled("", 9), scaled("1e3", 9), scaled("nan", 9), scaled("99999999999999", 9)], [None; 4]);
    }

    #[test]
    fn times_of_clocks_are_read() {
        // By GNU date: `date -u -d "2024-05-03 12:34:56" +%s`.
        let noon = 1_714_739_696_000_000_000;
        for cell in [
            "2024-05-03T12:34:56Z",
            "2024-05-03 12:34:56",
            "2024-05-03T14:34:56+02:00",
            "03.05.2024 12:34:56",
            "3.5.2024 12:34:56",
            "2024/05/03 12:34:56",
        ] {
            assert_eq!(clock_nanos(cell), Some(noon), "{cell}");
        }
        assert_eq!(clock_nanos("2024-05-03 12:34:56,789"), Some(noon + 789_000_000));
        assert_eq!(clock_nanos("03.05.2024 12:34:56.000001"), Some(noon + 1000));
        assert_eq!(clock_nanos("01:00:00.5"), Some(3_600_500_000_000));
        // The first could be the 3rd of May or the 5th of March.
        for cell in ["03/05/2024 12:34:56", "2024-05-03", "12.5", "a:b", "", "25:00:00"] {
            assert_eq!(clock_nanos(cell), None, "{cell}");
        }
    }

    #[test]
    fn a_file_has_points_or_commas() {
        let mut decimals = Decimals::default();
        assert_eq!(decimals.number("1,5"), Some(1.5));
        assert_eq!(decimals.number("-2"), Some(-2.0));
        assert_eq!(decimals.number("1.5"), None);
        let mut decimals = Decimals::default();
        assert_eq!(decimals.number("1.5"), Some(1.5));
        assert_eq!([decimals.number("1,234"), decimals.number("1,234.5"), decimals.number("x")], [None; 3]);
        assert!(decimals.number("").is_some_and(f64::is_nan) && decimals.number("NaN").is_some_and(f64::is_nan));
    }
}
