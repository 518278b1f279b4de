//! The result of an identification for people, as the tables of \[P\].

use fric_core::effects::Effect;
use fric_core::parameters::{FRICTION_COUNT, MU, OFFSET, SIGMA, VISCOUS};

use super::result::{FitCableResult, FitReference, FitResult, LogValues, OpenPartResult, OpenResult};
use crate::certainty::one_load::is_gain;
use crate::numbers::Numbers;
use crate::recording_fault::recording_lines;
use crate::search::vector::Parameter;
use crate::text::{digits_of, number, plain, significant, table, wrapped};

/// Returns \[P\] table I, the uncertainties, and what the log does not determine.
pub(crate) fn describe(result: &FitResult) -> String {
    let at_once = if result.reference == FitReference::Forces { "" } else { ", all cables at once" };
    let from = result.reference.in_words();
    let mut text = wrapped("", &format!("{}: friction identified from {from}{at_once}", result.robot)) + "\n";
    text += &paper_table(result);
    text += &legend(result);
    text += "\nstandard errors; ± twice as much holds the value with 95 %\n\n";
    text += &error_table(result);
    if FRICTION.iter().any(|shown| result.cables.iter().any(|cable| shown.is_conditional(result, cable))) {
        text += "\n* holds only with the kept value of an open combination, see below\n";
    }
    for effect in Effect::CATALOGUE {
        text += &effect_table(result, *effect);
    }
    text += &log_table(result.cables.iter().map(|cable| (cable.name.as_str(), cable.per_log.as_slice())));
    text += "\nsamples\n\n";
    let (header, rows) = samples(result);
    text += &table(&header, 1, &rows);
    text += &recording_lines(result.cables.iter().map(|cable| (cable.name.as_str(), cable.faults.as_slice())));
    if let Some(wrench) = &result.wrench {
        text += "\n";
        text += &wrench.table();
    }
    text += &undetermined(result);
    text
}

/// Returns the text of a cell that may be empty.
fn cell(text: Option<String>) -> String {
    text.unwrap_or_else(|| "–".to_owned())
}

/// A parameter as shown in the tables: name and unit, conversion factor, digits.
struct Shown {
    place: usize,
    symbol: &'static str,
    unit: &'static str,
    factor: f64,
    digits: usize,
}

/// The friction parameters in the order of [`Parameter::all`], with the units of \[P\] table I.
const FRICTION: [Shown; FRICTION_COUNT] = [
    Shown { place: MU, symbol: "μ", unit: "", factor: 1.0, digits: 5 },
    Shown { place: SIGMA, symbol: "σ", unit: "[N/mm]", factor: 1e-3, digits: 4 },
    Shown { place: VISCOUS, symbol: "F_pv", unit: "[Ns/m]", factor: 1.0, digits: 4 },
    Shown { place: OFFSET, symbol: "ε", unit: "[N]", factor: 1.0, digits: 4 },
];

impl Shown {
    fn of(&self, numbers: &Numbers) -> Option<f64> {
        Some(value_of(numbers, self.place)? * self.factor)
    }

    /// Returns the value, in brackets if it is not identified.
    fn value(&self, cable: &FitCableResult) -> String {
        let text = self.of(&cable.parameters).map(|value| number(value, self.digits));
        let is_at_bound = name_of(self.place).is_some_and(|name| cable.at_bound.contains(&name));
        let is_identified = is_at_bound || value_of(&cable.standard_errors, self.place).is_some();
        cell(text.map(|text| if is_identified { text } else { format!("({text})") }))
    }

    fn identified(&self, cable: &FitCableResult) -> Option<f64> {
        value_of(&cable.standard_errors, self.place).and_then(|_| self.of(&cable.parameters))
    }

    /// Returns the standard error, with a mark if it holds only with kept values.
    fn error(&self, result: &FitResult, cable: &FitCableResult) -> String {
        let mark = if self.is_conditional(result, cable) { "*" } else { "" };
        cell(self.of(&cable.standard_errors).map(|error| plain(error) + mark))
    }

    /// Whether the value is identified, and moves with one that is kept.
    fn is_conditional(&self, result: &FitResult, cable: &FitCableResult) -> bool {
        let Some(name) = name_of(self.place).filter(|_| self.identified(cable).is_some()) else { return false };
        let moved = result.cables.iter().flat_map(|of| &of.open).flat_map(|open| open.0.iter().skip(1));
        moved.into_iter().any(|part| part.cable == cable.name && part.parameter == name)
    }
}

/// Returns the number of a parameter by its index.
fn value_of(numbers: &Numbers, place: usize) -> Option<f64> {
    numbers.get(&name_of(place)?)
}

/// Returns the name of a parameter by its index.
fn name_of(place: usize) -> Option<String> {
    Parameter::all().nth(place).map(|parameter| parameter.to_string())
}

/// Returns the mean of the available numbers.
fn mean(numbers: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = numbers.fold((0.0, 0.0), |(sum, count), number| (sum + number, count + 1.0));
    (count > 0.0).then(|| sum / count)
}

/// A column of a table: name and unit, a cell per cable, and a cell below them.
struct Column {
    header: String,
    cells: Vec<String>,
    last: String,
}

impl Column {
    fn of_parameter(result: &FitResult, shown: &Shown) -> Option<Self> {
        let cables = &result.cables;
        let mean = mean(cables.iter().filter_map(|cable| shown.identified(cable)));
        cables.iter().any(|cable| shown.of(&cable.parameters).is_some()).then(|| Self {
            header: format!("{}\n{}", shown.symbol, shown.unit),
            cells: cables.iter().map(|cable| shown.value(cable)).collect(),
            last: cell(mean.map(|mean| number(mean, shown.digits))),
        })
    }

    fn of_parameter_error(result: &FitResult, shown: &Shown) -> Option<Self> {
        let cables = &result.cables;
        cables.iter().any(|cable| shown.of(&cable.standard_errors).is_some()).then(|| Self {
            header: format!("± {}\n{}", shown.symbol, shown.unit),
            cells: cables.iter().map(|cable| shown.error(result, cable)).collect(),
            last: String::new(),
        })
    }

    fn of_forces(
        result: &FitResult,
        header: &str,
        digits: usize,
        value: impl Fn(&FitCableResult) -> Option<f64>,
    ) -> Option<Self> {
        let values: Vec<Option<f64>> = result.cables.iter().map(value).collect();
        let mean = mean(values.iter().flatten().copied())?;
        let shown = |value: &Option<f64>| cell(value.map(|value| number(value, digits)));
        let last = number(mean, digits);
        Some(Self { header: format!("{header} [N]"), cells: values.iter().map(shown).collect(), last })
    }
}

/// Returns the table of the cables with these columns. If `last` has a name, it labels the row below them.
fn table_of(result: &FitResult, title: &str, columns: &[Column], last: Option<&str>) -> String {
    let header: Vec<&str> = std::iter::once(title).chain(columns.iter().map(|column| column.header.as_str())).collect();
    let row = |place: usize, name: &str| -> Vec<String> {
        let cells = columns.iter().map(|column| column.cells.get(place).unwrap_or(&column.last).clone());
        std::iter::once(name.to_owned()).chain(cells).collect()
    };
    let mut rows: Vec<Vec<String>> =
        result.cables.iter().enumerate().map(|(place, cable)| row(place, &cable.name)).collect();
    rows.extend(last.map(|name| row(usize::MAX, name)));
    table(&header, 1, &rows)
}

/// Returns \[P\] table I without columns that are unknown for all cables.
fn paper_table(result: &FitResult) -> String {
    let parameters = FRICTION.iter().filter(|shown| shown.place != OFFSET);
    let mut columns: Vec<Column> = parameters.filter_map(|shown| Column::of_parameter(result, shown)).collect();
    columns.extend(Column::of_forces(result, "mean error\nbefore", 4, |cable| Some(cable.before.as_ref()?.mae_n)));
    columns.extend(Column::of_forces(result, "mean error\nafter", 4, |cable| Some(cable.after.as_ref()?.mae_n)));
    columns.extend(Column::of_forces(result, "mean\nforce", 2, |cable| cable.mean_reference_n));
    table_of(result, "cable", &columns, (result.cables.len() > 1).then_some("mean"))
}

/// Explanation of the columns.
const LEGEND: &str = "μ is the friction of each bearing, σ the stiffness of the cable before it slides, F_pv the viscous friction of each \
                      pulley. The mean error is that of |force − reference| over all samples: before, as if nothing rubbed; after, \
                      with these values.";

/// Returns the explanation of the columns.
fn legend(result: &FitResult) -> String {
    let mut text = String::new();
    if result.cables.iter().any(|cable| cable.before.is_some()) {
        text.push('\n');
        text += &wrapped("", LEGEND);
    }
    let is_bracketed = |cable: &FitCableResult| FRICTION.iter().any(|shown| shown.value(cable).starts_with('('));
    if result.cables.iter().any(is_bracketed) {
        let is_contradicted = |cable: &FitCableResult| !cable.contradicted.is_empty();
        let kept = if result.cables.iter().any(is_contradicted) {
            "not identified"
        } else {
            "not identified but kept from the robot file"
        };
        let mean = if result.cables.len() > 1 { ", and left out of the mean, as are values at a bound" } else { "" };
        text.push('\n');
        text += &wrapped("", &format!("(…) is {kept}{mean}."));
    }
    text
}

/// Returns the uncertainty of each value and the columns that \[P\] table I does not have.
fn error_table(result: &FitResult) -> String {
    let mut columns = Vec::new();
    for shown in &FRICTION {
        columns.extend((shown.place == OFFSET).then(|| Column::of_parameter(result, shown)).flatten());
        columns.extend(Column::of_parameter_error(result, shown));
    }
    columns.extend(Column::of_forces(result, "rms error\nbefore", 4, |cable| Some(cable.before.as_ref()?.rms_n)));
    columns.extend(Column::of_forces(result, "rms error\nafter", 4, |cable| Some(cable.after.as_ref()?.rms_n)));
    table_of(result, "cable", &columns, None)
}

/// Returns the parameters of an effect with their standard errors; empty for an effect that no cable has.
fn effect_table(result: &FitResult, effect: Effect) -> String {
    let mut columns = Vec::new();
    for parameter in Parameter::all().filter(|parameter| parameter.effect() == Some(effect)) {
        let name = parameter.to_string();
        let value = |cable: &FitCableResult| {
            let value = cable.parameters.get(&name)?;
            // The value has as many digits as its error, which has two.
            let error = cable.standard_errors.get(&name);
            Some(match error {
                Some(error) => number(value, digits_of(error)),
                None => format!("({})", significant(value)),
            })
        };
        let header = parameter.row().key.to_owned();
        let cells: Vec<Option<String>> = result.cables.iter().map(value).collect();
        if cells.iter().any(Option::is_some) {
            let error = |cable: &FitCableResult| cell(cable.standard_errors.get(&name).map(plain));
            columns.push(Column { header, cells: cells.into_iter().map(cell).collect(), last: String::new() });
            let cells = result.cables.iter().map(error).collect();
            columns.push(Column { header: "±".to_owned(), cells, last: String::new() });
        }
    }
    if columns.is_empty() {
        String::new()
    } else {
        format!("\n{}", table_of(result, &effect.to_string(), &columns, None))
    }
}

/// Returns what each log has of its own on each cable, and what of it stands in a robot file; empty if the logs share all parameters.
pub(crate) fn log_table<'a>(cables: impl Iterator<Item = (&'a str, &'a [LogValues])>) -> String {
    let (mut rows, mut parameter) = (Vec::new(), None);
    for (name, logs) in cables {
        for log in logs {
            let value = log.parameters.0.first();
            let error = value.and_then(|(name, _)| log.standard_errors.get(name));
            parameter = parameter.or(value.map(|(name, _)| name.as_str()));
            rows.push(vec![
                name.to_owned(),
                log.log.clone(),
                cell(value.map(|(_, value)| number(*value, error.map_or(4, digits_of)))),
                cell(error.map(plain)),
            ]);
        }
    }
    let Some(parameter) = parameter else { return String::new() };
    let title = format!("{parameter}: {}", LogValues::EXPLANATION);
    format!("\n{}\n{}", wrapped("", &title), table(&["cable", "log", &format!("{parameter}\n[N]"), "±"], 2, &rows))
}

/// Returns header and rows of the table of the training samples; one row if it is the same for all cables.
pub(super) fn samples(result: &FitResult) -> (Vec<&'static str>, Vec<Vec<String>>) {
    type Count = fn(&FitCableResult) -> usize;
    let no_reference = if result.reference == FitReference::Forces { "no reference" } else { "no wrench" };
    let all: [(&'static str, Count); 6] = [
        ("used", |cable| cable.samples),
        ("flagged", |cable| cable.left_out.flagged),
        (no_reference, |cable| cable.left_out.without_reference),
        ("warm-up", |cable| cable.left_out.warm_up),
        ("outliers", |cable| cable.left_out.outliers),
        ("evaluations", |cable| cable.evaluations),
    ];
    let counts: Vec<(&'static str, Count)> =
        all.into_iter().filter(|(_, count)| result.cables.iter().any(|cable| count(cable) > 0)).collect();
    let mut header = vec!["cable"];
    header.extend(counts.iter().map(|(name, _)| *name));
    header.push("search");
    let row = |cable: &FitCableResult| -> Vec<String> {
        let numbers = counts.iter().map(|(_, count)| count(cable).to_string());
        numbers.chain([cable.termination.to_owned()]).collect()
    };
    let cells: Vec<Vec<String>> = result.cables.iter().map(row).collect();
    let is_same = cells.len() > 1 && cells.windows(2).all(|pair| pair.first() == pair.last());
    let names = result.cables.iter().map(|cable| if is_same { "all" } else { cable.name.as_str() });
    let rows = names.zip(cells).map(|(name, cells)| std::iter::once(name.to_owned()).chain(cells).collect());
    (header, rows.take(if is_same { 1 } else { usize::MAX }).collect())
}

/// Returns what the log cannot determine, and what to record for it.
fn undetermined(result: &FitResult) -> String {
    let mut text = String::new();
    // A cable without samples has already been reported.
    let learned: Vec<&FitCableResult> = result.cables.iter().filter(|cable| cable.samples > 0).collect();
    for parameter in Parameter::all() {
        let name = parameter.to_string();
        let is_open_with_others = |cable: &FitCableResult| cable.open.iter().any(|open| open.is_held(&name));
        let without = learned.iter().filter(|cable| cable.undetermined.contains(&name) && !is_open_with_others(cable));
        let cables: Vec<&str> = without.map(|cable| cable.name.as_str()).collect();
        if !cables.is_empty() {
            let cables = listed(&cables, result);
            let sentence =
                format!("The log does not determine {} of {cables}: the given value is kept.", shown_name(&parameter));
            text.push('\n');
            text += &wrapped("", &sentence);
            text += &wrapped("  ", &format!("Record {}.", parameter.row().excitation));
        }
    }
    for cable in &learned {
        for name in &cable.contradicted {
            let Some(parameter) = Parameter::named(name) else { continue };
            // Contacts that do not yield have no σ.
            let others = cable.parameters.get(name).map_or_else(
                || "contacts that do not yield agree with it".to_owned(),
                |value| {
                    format!("{} {} is one of many values that agree with it", significant(value), parameter.row().unit)
                },
            );
            let shown = shown_name(&parameter);
            let sentence = format!(
                "The log contradicts the given {shown} of {} without determining another; {others}.",
                cable.name
            );
            text.push('\n');
            text += &wrapped("", &sentence);
        }
    }
    for cable in &learned {
        for open in &cable.open {
            text += &open_combination(cable, open);
        }
    }
    for parameter in Parameter::all() {
        let name = parameter.to_string();
        let at_bound = learned.iter().filter(|cable| cable.at_bound.contains(&name));
        let cables: Vec<&str> = at_bound.map(|cable| cable.name.as_str()).collect();
        if let Some(value) =
            learned.iter().find(|cable| cable.at_bound.contains(&name)).and_then(|cable| cable.parameters.get(&name))
        {
            let sentence = format!(
                "{} of {} is at its bound of {value}: the log would have it beyond. Something else is missing in the model, or the parameter has \
                 nothing to explain.",
                shown_name(&parameter),
                listed(&cables, result)
            );
            text.push('\n');
            text += &wrapped("", &sentence);
            if parameter.place() == MU && value <= parameter.row().min {
                let question = "Does the length grow where it should shrink, or is a force at the winch taken for one at the platform?";
                text += &wrapped("  ", question);
            }
        }
    }
    text
}

/// Returns the parameter with its symbol in the tables, if it has one.
fn shown_name(parameter: &Parameter) -> String {
    let symbol = FRICTION.iter().find(|shown| shown.place == parameter.place());
    symbol.map_or_else(|| parameter.to_string(), |shown| format!("{} ({parameter})", shown.symbol))
}

/// Returns the cables' names, unless it is all of several.
fn listed(cables: &[&str], result: &FitResult) -> String {
    if cables.len() == result.cables.len() && cables.len() > 1 { "any cable".to_owned() } else { cables.join(", ") }
}

/// Returns the parameters that change with a kept parameter.
fn open_combination(cable: &FitCableResult, open: &OpenResult) -> String {
    let Some((held, others)) = open.0.split_first() else { return String::new() };
    let unit = |name: &str| Parameter::named(name).map_or("", |parameter| parameter.row().unit);
    let part = |part: &OpenPartResult| {
        let unit = match unit(&part.parameter) {
            "1" => String::new(),
            unit => format!(" {unit}"),
        };
        let of = if part.cable == cable.name { String::new() } else { format!(" of {}", part.cable) };
        let sign = if part.step < 0.0 { "−" } else { "+" };
        format!("{}{of} {sign}{}{unit}", part.parameter, plain(part.step.abs()))
    };
    let mut listed = vec![part(held).replacen(&held.parameter, &format!("{} of {}", held.parameter, cable.name), 1)];
    listed.extend(others.iter().map(part));
    // Of a zero beside a gain, other loads tell both.
    let all = || open.0.iter().filter_map(|part| Parameter::named(&part.parameter));
    let excitation = all().find(is_gain).or(all().next()).map_or("", |parameter| parameter.row().excitation);
    let advice = format!(
        "{} of {} is kept as given, and the others hold with it. To tell them apart record {excitation}.",
        held.parameter, cable.name
    );
    format!(
        "\nThe log leaves a combination open: these together change nothing that it shows.\n{}{}",
        wrapped("  ", &listed.join(", ")),
        wrapped("  ", &advice)
    )
}
