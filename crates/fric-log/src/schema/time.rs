//! Converts the times of message formats to whole nanoseconds.

const NANOS_PER_S: i64 = 1_000_000_000;

/// The error of a time that does not fit into 64 bits of nanoseconds, or whose nanoseconds are a second or more.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct OutOfRange;

/// Converts seconds and nanoseconds, which may have opposite signs, to nanoseconds.
pub(super) fn from_parts(seconds: i64, nanos: i64) -> Result<i64, OutOfRange> {
    if nanos.unsigned_abs() >= NANOS_PER_S.unsigned_abs() {
        return Err(OutOfRange);
    }
    let total = i128::from(seconds) * i128::from(NANOS_PER_S) + i128::from(nanos);
    i64::try_from(total).map_err(|_| OutOfRange)
}

/// Converts seconds to nanoseconds, rounded.
///
/// An `f64` of seconds since 1970 resolves about 0.2 µs.
pub(super) fn from_seconds(seconds: f64) -> Result<i64, OutOfRange> {
    // The fraction is separated first, because the product alone would lose digits.
    let whole = seconds.floor();
    if !(-9.0e9..9.0e9).contains(&whole) {
        return Err(OutOfRange);
    }
    #[expect(clippy::cast_possible_truncation, reason = "bounded just above")]
    let (whole, nanos) = (whole as i64, ((seconds - whole) * 1e9).round() as i64);
    Ok(whole * NANOS_PER_S + nanos)
}

/// Parses an RFC 3339 time such as `2024-05-01T12:00:00.25+02:00` to nanoseconds since 1970.
pub(super) fn from_rfc3339(text: &str) -> Option<Result<i64, OutOfRange>> {
    let mut rest = text.as_bytes();
    let year = digits(&mut rest, 4)?;
    take(&mut rest, b"-")?;
    let month = digits(&mut rest, 2)?;
    take(&mut rest, b"-")?;
    let day = digits(&mut rest, 2)?;
    take(&mut rest, b"Tt ")?;
    let hour = digits(&mut rest, 2)?;
    take(&mut rest, b":")?;
    let minute = digits(&mut rest, 2)?;
    take(&mut rest, b":")?;
    let second = digits(&mut rest, 2)?;
    let nanos = match take(&mut rest, b".,") {
        Some(_) => fraction_nanos(&mut rest)?,
        None => 0,
    };
    let offset_minutes = match take(&mut rest, b"Zz+-")? {
        sign @ (b'+' | b'-') => {
            let hours = digits(&mut rest, 2)?;
            take(&mut rest, b":")?;
            let minutes = digits(&mut rest, 2)?;
            let offset = hours * 60 + minutes;
            if sign == b'-' { -offset } else { offset }
        }
        _ => 0,
    };
    let day_exists = (1..=12).contains(&month) && (1..=days_in_month(year, month)).contains(&day);
    if !rest.is_empty() || !day_exists || hour > 23 || minute > 59 || second > 60 {
        return None;
    }
    let minutes = (days_since_1970(year, month, day) * 24 + hour) * 60 + minute - offset_minutes;
    Some(from_parts(minutes * 60 + second, nanos))
}

fn take(rest: &mut &[u8], any_of: &[u8]) -> Option<u8> {
    let (first, after) = rest.split_first()?;
    if !any_of.contains(first) {
        return None;
    }
    *rest = after;
    Some(*first)
}

fn digits(rest: &mut &[u8], count: usize) -> Option<i64> {
    (0..count).try_fold(0, |value, _| Some(value * 10 + digit(rest)?))
}

fn digit(rest: &mut &[u8]) -> Option<i64> {
    take(rest, b"0123456789").map(|digit| i64::from(digit - b'0'))
}

/// Parses one digit or more; those past the ninth are cut off.
fn fraction_nanos(rest: &mut &[u8]) -> Option<i64> {
    let mut nanos = digit(rest)? * (NANOS_PER_S / 10);
    let mut unit = NANOS_PER_S / 100;
    while let Some(digit) = digit(rest) {
        nanos += digit * unit;
        unit /= 10;
    }
    Some(nanos)
}

fn is_leap_year(year: i64) -> bool {
    year % 4 == 0 && (year % 100 != 0 || year % 400 == 0)
}

fn days_in_month(year: i64, month: i64) -> i64 {
    match month {
        2 if is_leap_year(year) => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        _ => 31,
    }
}

fn days_since_1970(year: i64, month: i64, day: i64) -> i64 {
    // Leap days before the year, in the proleptic calendar.
    let leap_days = |year: i64| {
        let past = year - 1;
        past.div_euclid(4) - past.div_euclid(100) + past.div_euclid(400)
    };
    let years = (year - 1970) * 365 + leap_days(year) - leap_days(1970);
    let months: i64 = (1..month).map(|month| days_in_month(year, month)).sum();
    years + months + day - 1
}
