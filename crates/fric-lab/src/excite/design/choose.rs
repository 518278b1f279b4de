//! Chooses the pieces of a run: the piece with the greatest value for its duration is added first, and then each piece is exchanged for a better one
//! as long as there is one (the exchange of V. V. Fedorov, *Theory of Optimal Experiments*, 1972, ch. 3).

use super::criterion::{Sums, Test, Tests, objective};

/// Maximum number of exchange rounds.
const ROUNDS: usize = 6;
/// Minimum gain of an exchange, in the logarithm of a score.
const WORTH: f64 = 1e-3;

/// Returns the indices of the pieces of a run that takes no longer than `time_s`; a piece may occur several times. `durations_s` holds the durations
/// of the pieces. The `needed` ones are among them as far as they fit, whatever they are worth.
pub fn choose(tests: &Tests, durations_s: &[f64], time_s: f64, needed: &[usize]) -> Vec<usize> {
    let mut chosen: Vec<usize> = Vec::new();
    for place in needed {
        if fitting(durations_s, &chosen, time_s).contains(place) {
            chosen.push(*place);
        }
    }
    let kept = chosen.len();
    for _ in 0..ROUNDS {
        fill(tests, durations_s, time_s, &mut chosen);
        if !exchange(tests, durations_s, time_s, &mut chosen, kept) {
            break;
        }
    }
    chosen
}

/// Adds pieces as long as one fits.
fn fill(tests: &Tests, durations_s: &[f64], time_s: f64, chosen: &mut Vec<usize>) {
    loop {
        let sums = sums_of(tests, chosen);
        let before = objective(tests, &sums);
        let worth = |place: usize| (with_piece(tests, &sums, place) - before) / durations_s[place];
        let fitting = fitting(durations_s, chosen, time_s);
        let Some((next, _)) = best(fitting.into_iter().map(|place| (place, worth(place)))) else { return };
        chosen.push(next);
    }
}

/// Exchanges each piece but the first `kept` for the best in its place. Returns whether any was exchanged.
fn exchange(tests: &Tests, durations_s: &[f64], time_s: f64, chosen: &mut [usize], kept: usize) -> bool {
    let mut improved = false;
    for slot in kept..chosen.len() {
        let mut others = chosen.to_vec();
        let present = others.swap_remove(slot);
        let sums = sums_of(tests, &others);
        let worth = |place: usize| with_piece(tests, &sums, place);
        let fitting = fitting(durations_s, &others, time_s);
        let Some((next, value)) = best(fitting.into_iter().map(|place| (place, worth(place)))) else { continue };
        if next != present && value > worth(present) + WORTH {
            chosen[slot] = next;
            improved = true;
        }
    }
    improved
}

/// Returns the pieces that fit into the remaining time.
fn fitting(durations_s: &[f64], chosen: &[usize], time_s: f64) -> Vec<usize> {
    let taken_s: f64 = chosen.iter().filter_map(|place| durations_s.get(*place)).sum();
    (0..durations_s.len()).filter(|place| durations_s[*place] <= time_s - taken_s).collect()
}

/// Returns the first of the best.
fn best(all: impl Iterator<Item = (usize, f64)>) -> Option<(usize, f64)> {
    all.reduce(|best, other| if other.1 > best.1 { other } else { best })
}

fn sums_of(tests: &Tests, chosen: &[usize]) -> Vec<Vec<Sums>> {
    let of_test = |test: &Test| {
        let none = Sums::new(test.pieces.first().map_or(0, Sums::parameter_count));
        chosen.iter().filter_map(|place| test.pieces.get(*place)).fold(none, |sum, piece| sum.with(piece))
    };
    tests.iter().map(|tests| tests.iter().map(of_test).collect()).collect()
}

/// Returns the value of the run with one more piece.
fn with_piece(tests: &Tests, sums: &[Vec<Sums>], place: usize) -> f64 {
    let of_question = |(tests, sums): (&Vec<Test>, &Vec<Sums>)| {
        let added = tests
            .iter()
            .zip(sums)
            .map(|(test, sum)| test.pieces.get(place).map_or_else(|| sum.clone(), |piece| sum.with(piece)));
        added.collect::<Vec<Sums>>()
    };
    let sums: Vec<Vec<Sums>> = tests.iter().zip(sums).map(of_question).collect();
    objective(tests, &sums)
}

#[cfg(test)]
mod tests {
    use super::choose;

    #[test]
    fn a_needed_piece_is_chosen_if_it_fits() {
        let durations_s = [3.0, 4.0, 6.0];
        let chosen = choose(&Vec::new(), &durations_s, 10.0, &[2]);
        let taken_s: f64 = chosen.iter().map(|place| durations_s[*place]).sum();
        assert!(chosen.contains(&2) && taken_s <= 10.0, "{chosen:?}");
        assert!(!choose(&Vec::new(), &durations_s, 5.0, &[2]).contains(&2));
    }
}
