//! Start values for effects that a fit is asked for but the robot file lacks.
//!
//! At its neutral values an effect does nothing, and neither do most of its parameters, so no search leaves that point. The rest of the model is
//! therefore fitted first. Each such effect is then added from the starts that the discovery uses, and the search continues from the best. In a fit
//! to the wrench all cables use the same start at once. A ripple has no start there, because its period shows only in the force of a cable, which is
//! not measured.

use std::sync::Arc;

use fric_core::effects::Effect;
use fric_core::parameters::{MU, Values};

use super::catalogue;
use super::ripple::periods;
use crate::samples::noise::white_noise;
use crate::search::pass::Forces;
use crate::search::problem::{Comparison, Member, Problem};
use crate::search::solve::search;
use crate::search::vector::Parameter;

/// Returns start values with all requested effects: the given ones if the cables have all of them.
pub fn with_newcomers(
    problem: &Problem<'_>,
    starts: Vec<Vec<Values>>,
    given: &[Values],
    cycle_s: f64,
) -> Vec<Vec<Values>> {
    let is_new = |effect: &Effect| {
        let of_member = |(member, given): (&Member<'_>, &Values)| {
            wanted(*effect, member).next().is_some() && !catalogue::has(*effect, given)
        };
        problem.members.iter().zip(given).any(of_member)
    };
    let newcomers: Vec<Effect> = Effect::CATALOGUE.iter().copied().filter(is_new).collect();
    if newcomers.is_empty() {
        return starts;
    }
    let mut growing = problem.clone();
    for member in &mut growing.members {
        member.free.retain(|parameter| !parameter.effect().is_some_and(|effect| newcomers.contains(&effect)));
    }
    let Some(mut current) = best(&growing, starts, cycle_s) else { return Vec::new() };
    for effect in newcomers {
        let entrants = entrants(effect, &growing, problem, &current, given);
        for (member, whole) in growing.members.iter_mut().zip(&problem.members) {
            member.free.extend(wanted(effect, whole));
        }
        current = best(&growing, entrants, cycle_s).unwrap_or(current);
    }
    vec![current]
}

/// Returns the parameters of an effect to vary.
fn wanted<'a>(effect: Effect, member: &'a Member<'_>) -> impl Iterator<Item = Parameter> + 'a {
    member.free.iter().copied().filter(move |parameter| parameter.effect() == Some(effect))
}

/// Returns the best of several minima.
fn best(problem: &Problem<'_>, starts: Vec<Vec<Values>>, cycle_s: f64) -> Option<Vec<Values>> {
    let minima = starts.into_iter().map(|start| search(problem, &start, cycle_s));
    minima.min_by(|(_, one), (_, other)| one.squares.total_cmp(&other.squares)).map(|(values, _)| values)
}

/// Returns start values of all cables with an effect.
fn entrants(
    effect: Effect,
    growing: &Problem<'_>,
    whole: &Problem<'_>,
    current: &[Values],
    given: &[Values],
) -> Vec<Vec<Values>> {
    let forces = growing.forces(current).unwrap_or_default();
    let shifts_n = current.first().and_then(|values| growing.zero_shifts_n(values));
    let of_member = |((member, forces), (values, given)): ((&Member<'_>, &Arc<Forces>), (&Values, &Values))| {
        if catalogue::has(effect, given) {
            return vec![*values];
        }
        let residual_n = residual_n(growing, member, forces, shifts_n.as_deref());
        let mut around = catalogue::around(&member.record, values[MU], white_noise(&residual_n).unwrap_or(0.0));
        around.periods = periods(&member.record, &residual_n);
        let free: Vec<Parameter> = wanted(effect, member).collect();
        let mut starts = catalogue::starts(effect, values, &around, &member.record);
        for start in &mut starts {
            // Parameters that are not requested stay as given. Settings have no meaningful given value.
            let stays = |parameter: &Parameter| parameter.row().fitted && !free.contains(parameter);
            for parameter in Parameter::of(effect).filter(stays) {
                start[parameter.place()] = given[parameter.place()];
            }
        }
        starts
    };
    let members = whole.members.iter().zip(&forces).zip(current.iter().zip(given));
    let of_members: Vec<Vec<Values>> = members.map(of_member).collect();
    let count = of_members.iter().map(Vec::len).max().unwrap_or(0);
    let of_start = |start: usize| {
        let of_member = |(starts, current): (&Vec<Values>, &Values)| {
            starts.get(start).or_else(|| starts.last()).copied().unwrap_or(*current)
        };
        of_members.iter().zip(current).map(of_member).collect()
    };
    (0..count).map(of_start).collect()
}

/// Returns the model's residual for a cable's reference. In a fit to the wrench it is the white noise of the cable's own force, without a reference.
fn residual_n(problem: &Problem<'_>, member: &Member<'_>, forces: &Forces, zero_shifts_n: Option<&[f64]>) -> Vec<f64> {
    let references_n = member.record.references_n.iter().enumerate();
    let shift_n = |cycle: usize| zero_shifts_n.and_then(|shifts_n| shifts_n.get(cycle)).copied().unwrap_or(0.0);
    match problem.comparison {
        Comparison::Forces => {
            references_n.map(|(cycle, reference_n)| forces.at(cycle).0 - reference_n + shift_n(cycle)).collect()
        }
        Comparison::Wrench { .. } => Vec::new(),
    }
}
