//! The true backbone of the simulation: a finely divided elastica of minimum energy.
//!
//! Every segment is a chain of short rigid links with a spring in each joint, with a stiffness of EI divided by the length of a link. The loads are
//! the straight tendons between the disks, each under its tension, and dead weight. The shape is the minimum of
//!
//! `V = Σ ½(EI/h)(ψ_{k+1} − ψ_k)² + Σ T_j·ℓ_j − Σ W·p`
//!
//! over the directions ψ of the links, found by Newton's method with a banded Cholesky factor and a line search that decreases the energy. A disk
//! sits in a joint and has the mean direction of its two links; the joints at the base and the tip have half a link on one side. The model shares
//! none of this: not the unknowns, not the curvature (that of an elastica, not constant), not the balance of forces (none is written down), not the
//! method.

use fric_tendon::ManipulatorParams;
use nalgebra::Vector2;

use super::banded::{Banded, Factor};

/// Maximum number of Newton steps for one minimum.
const MOST_STEPS: u32 = 200;

/// A manipulator of many links.
#[derive(Clone, Debug)]
pub struct Elastica {
    segments: usize,
    /// Number of links in a segment.
    links: usize,
    /// Length of a link in each segment, m.
    link_m: Vec<f64>,
    hole_m: f64,
    /// Greatest EI/h, N m.
    spring_nm: f64,
    /// Stiffness of each joint, N m, and its unloaded angle, rad.
    springs: Vec<(f64, f64)>,
    /// Force of everything beyond a link, including half its own weight, N.
    beyond_n: Vec<Vector2<f64>>,
    /// Directions of the links, and of the last disk, rad.
    angle_rad: Vec<f64>,
    hessian: Banded,
}

/// A straight piece of tendon between two disks.
#[derive(Clone, Debug)]
pub struct Strand {
    /// Length, m.
    pub length_m: f64,
    /// Direction towards the tip.
    pub direction: Vector2<f64>,
    /// Index of the first angle that it depends on.
    first: usize,
    /// Derivatives of its length with respect to these angles, m.
    slopes_m: Vec<f64>,
}

/// The error that no shape was found: the energy has no minimum nearby, for instance when a column buckles without limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoMinimum;

impl Elastica {
    /// Creates a straight manipulator with `links` links in a segment.
    pub fn new(params: &ManipulatorParams, links: usize) -> Self {
        let segments = params.disk_count();
        let count = segments * links;
        #[expect(clippy::cast_precision_loss, reason = "a number of links")]
        let link_m: Vec<f64> = params.pitch_m().iter().map(|pitch_m| pitch_m / links as f64).collect();
        let [disk_n, backbone_n, tip_n] = params.loads_n().map(Vector2::from);
        let mut force_n = tip_n;
        let mut beyond_n = vec![Vector2::zeros(); count];
        for (place, beyond_n) in beyond_n.iter_mut().enumerate().rev() {
            if (place + 1) % links == 0 {
                force_n += disk_n;
            }
            // The stated weight is that of the first segment.
            let link_n = backbone_n * (link_m[place / links] / params.pitch_m()[0]);
            *beyond_n = force_n + 0.5 * link_n;
            force_n += link_n;
        }
        let springs = (0..=count).map(|place| joint(params, links, &link_m, place)).collect();
        let shortest_m = link_m.iter().copied().fold(f64::INFINITY, f64::min);
        Self {
            springs,
            segments,
            links,
            link_m,
            hole_m: params.hole_radius_m(),
            spring_nm: params.bending_stiffness_n_m2() / shortest_m,
            beyond_n,
            angle_rad: vec![0.0; count + 1],
            hessian: Banded::new(count + 1, links + 1),
        }
    }

    /// Returns the indices of the angles whose mean is the direction of the disk at the end of a segment (0: the base plate).
    fn disk(&self, disk: usize) -> [Option<usize>; 2] {
        match disk {
            0 => [None, None],
            last if last == self.segments => [Some(last * self.links), Some(last * self.links)],
            inner => [Some(inner * self.links - 1), Some(inner * self.links)],
        }
    }

    fn disk_rad(&self, disk: usize) -> f64 {
        self.disk(disk).into_iter().flatten().map(|place| 0.5 * self.angle_rad[place]).sum()
    }

    /// Returns the bend of the whole manipulator, rad.
    pub fn bend_rad(&self) -> f64 {
        self.disk_rad(self.segments)
    }

    /// Returns the centres of the disks, m.
    pub fn disk_position_m(&self) -> Vec<[f64; 2]> {
        let mut place_m = Vector2::zeros();
        let segments = self.angle_rad[..self.segments * self.links].chunks(self.links);
        segments
            .zip(&self.link_m)
            .map(|(angles_rad, link_m)| {
                place_m += angles_rad.iter().map(|angle| *link_m * unit(*angle)).sum::<Vector2<f64>>();
                place_m.into()
            })
            .collect()
    }

    /// Returns the tendon in a segment (from 0) on a side, +1 towards +y.
    pub fn strand(&self, segment: usize, side: f64) -> Strand {
        let offset_m = side * self.hole_m;
        let first = (segment * self.links).saturating_sub(1);
        let last = ((segment + 1) * self.links).min(self.angle_rad.len() - 1);
        let own = segment * self.links..(segment + 1) * self.links;
        let (begin_rad, end_rad) = (self.disk_rad(segment), self.disk_rad(segment + 1));
        let link_m = self.link_m[segment];
        let across = self.angle_rad[own.clone()].iter().map(|angle| link_m * unit(*angle)).sum::<Vector2<f64>>();
        let chord_m = across + offset_m * (normal(end_rad) - normal(begin_rad));
        let length_m = chord_m.norm();
        let direction = chord_m / length_m;
        let mut slopes_m = vec![0.0; last - first + 1];
        for place in own {
            slopes_m[place - first] += link_m * normal(self.angle_rad[place]).dot(&direction);
        }
        for (disk, sign, angle_rad) in [(segment, -1.0, begin_rad), (segment + 1, 1.0, end_rad)] {
            for place in self.disk(disk).into_iter().flatten() {
                slopes_m[place - first] -= sign * 0.5 * offset_m * unit(angle_rad).dot(&direction);
            }
        }
        Strand { length_m, direction, first, slopes_m }
    }

    /// Returns the energy up to a constant, N m.
    fn energy_nm(&self, tension_n: [&[f64]; 2]) -> f64 {
        let mut energy = 0.0;
        self.joints(|_, _, stiffness, difference| energy += 0.5 * stiffness * difference * difference);
        for (place, (angle, beyond_n)) in self.angle_rad.iter().zip(&self.beyond_n).enumerate() {
            energy -= self.link_m[place / self.links] * unit(*angle).dot(beyond_n);
        }
        for (side, tension_n) in [1.0, -1.0].into_iter().zip(tension_n) {
            for (segment, tension_n) in tension_n.iter().enumerate() {
                energy += tension_n * self.strand(segment, side).length_m;
            }
        }
        energy
    }

    /// Calls `each` for every joint with the indices of both links (`None`: the base), its stiffness and its angle relative to the unloaded state.
    fn joints(&self, mut each: impl FnMut(Option<usize>, usize, f64, f64)) {
        for ((place, angle), (stiffness, rest_rad)) in self.angle_rad.iter().enumerate().zip(&self.springs) {
            let before = place.checked_sub(1);
            each(before, place, *stiffness, angle - before.map_or(0.0, |before| self.angle_rad[before]) - rest_rad);
        }
    }

    /// Writes the second derivatives of the energy and returns the first ones.
    fn derivatives(&mut self, tension_n: [&[f64]; 2]) -> Vec<f64> {
        let mut hessian = std::mem::replace(&mut self.hessian, Banded::new(0, 0));
        hessian.clear();
        let mut gradient = vec![0.0; self.angle_rad.len()];
        self.joints(|before, place, stiffness, difference| {
            gradient[place] += stiffness * difference;
            hessian.add(place, place, stiffness);
            if let Some(before) = before {
                gradient[before] -= stiffness * difference;
                hessian.add(before, before, stiffness);
                hessian.add(place, before, -stiffness);
            }
        });
        for (place, (angle, beyond_n)) in self.angle_rad.iter().zip(&self.beyond_n).enumerate() {
            let link_m = self.link_m[place / self.links];
            gradient[place] -= link_m * normal(*angle).dot(beyond_n);
            hessian.add(place, place, link_m * unit(*angle).dot(beyond_n));
        }
        for (side, tension_n) in [1.0, -1.0].into_iter().zip(tension_n) {
            for (segment, &tension_n) in tension_n.iter().enumerate() {
                if tension_n != 0.0 {
                    self.add_strand(segment, side, tension_n, &mut gradient, &mut hessian);
                }
            }
        }
        self.hessian = hessian;
        gradient
    }

    /// Adds the derivatives of `T·ℓ`: with the chord d of direction e, `ℓ' = e·d'`, `ℓ'' = e·d'' + (d'·d' − ℓ'ℓ')/ℓ`.
    fn add_strand(&self, segment: usize, side: f64, tension_n: f64, gradient: &mut [f64], hessian: &mut Banded) {
        let strand = self.strand(segment, side);
        let offset_m = side * self.hole_m;
        let mut moves = vec![Vector2::zeros(); strand.slopes_m.len()];
        let link_m = self.link_m[segment];
        for place in segment * self.links..(segment + 1) * self.links {
            moves[place - strand.first] += link_m * normal(self.angle_rad[place]);
            let bend_m = -link_m * unit(self.angle_rad[place]).dot(&strand.direction);
            hessian.add(place, place, tension_n * bend_m);
        }
        for (disk, sign) in [(segment, -1.0), (segment + 1, 1.0)] {
            let angle_rad = self.disk_rad(disk);
            let places = self.disk(disk);
            for one in places.into_iter().flatten() {
                moves[one - strand.first] -= sign * 0.5 * offset_m * unit(angle_rad);
                for other in places.into_iter().flatten() {
                    let bend_m = -sign * 0.25 * offset_m * normal(angle_rad).dot(&strand.direction);
                    hessian.add(one, other, tension_n * bend_m);
                }
            }
        }
        for (one, (move_m, slope_m)) in moves.iter().zip(&strand.slopes_m).enumerate() {
            gradient[strand.first + one] += tension_n * slope_m;
            for (other, (other_m, other_slope_m)) in moves.iter().zip(&strand.slopes_m).enumerate().take(one + 1) {
                let bend_m = (move_m.dot(other_m) - slope_m * other_slope_m) / strand.length_m;
                hessian.add(strand.first + one, strand.first + other, tension_n * bend_m);
            }
        }
    }

    /// Moves to the nearest minimum of the energy under these tensions of both tendons in the segments, N. Returns the factor of the second
    /// derivatives there.
    pub fn settle(&mut self, tension_n: [&[f64]; 2]) -> Result<Factor, NoMinimum> {
        let mut energy_nm = self.energy_nm(tension_n);
        for _ in 0..MOST_STEPS {
            let mut step = self.derivatives(tension_n);
            let steepness = step.iter().fold(0.0_f64, |most, slope| most.max(slope.abs()));
            let mut shift = 0.0;
            let factor = loop {
                if let Some(factor) = self.hessian.factor(shift) {
                    break factor;
                }
                shift = (4.0 * shift).max(1e-3 * self.spring_nm);
            };
            if steepness < 1e-13 * self.spring_nm && shift == 0.0 {
                return Ok(factor);
            }
            factor.solve(&mut step);
            let longest = step.iter().fold(0.0_f64, |most, change| most.max(change.abs()));
            let begin = self.angle_rad.clone();
            let mut share = (0.3 / longest).min(1.0);
            let mut found = false;
            for _ in 0..40 {
                for ((angle, begin), change) in self.angle_rad.iter_mut().zip(&begin).zip(&step) {
                    *angle = begin - share * change;
                }
                let trial_nm = self.energy_nm(tension_n);
                // Near the minimum the energy cannot distinguish the points any more; the full step is right there.
                if trial_nm < energy_nm || longest < 1e-6 {
                    (energy_nm, found) = (trial_nm, true);
                    break;
                }
                share *= 0.5;
            }
            if !found {
                self.angle_rad = begin;
                return if shift == 0.0 && longest < 1e-4 { Ok(factor) } else { Err(NoMinimum) };
            }
            if shift == 0.0 && longest < 1e-8 {
                return Ok(factor);
            }
        }
        Err(NoMinimum)
    }

    /// Returns the change in length of each piece of tendon on a side per newton of tension in each of them, m/N.
    pub fn compliance(&self, factor: &Factor, side: f64) -> Vec<Vec<f64>> {
        let strands: Vec<Strand> = (0..self.segments).map(|segment| self.strand(segment, side)).collect();
        strands
            .iter()
            .map(|loaded| {
                let mut turn = vec![0.0; self.angle_rad.len()];
                for (turn, slope_m) in turn[loaded.first..].iter_mut().zip(&loaded.slopes_m) {
                    *turn = -slope_m;
                }
                factor.solve(&mut turn);
                let change = |strand: &Strand| {
                    strand.slopes_m.iter().zip(&turn[strand.first..]).map(|(slope, turn)| slope * turn).sum()
                };
                strands.iter().map(change).collect()
            })
            .collect()
    }
}

/// Returns the stiffness of a joint, N m, and its unloaded angle, rad: half a link on either side, each of its own segment; at base and tip only one
/// half.
fn joint(params: &ManipulatorParams, links: usize, link_m: &[f64], place: usize) -> (f64, f64) {
    let half = |link: usize| {
        let segment = link / links;
        let stiffness_n_m2 = params.segment_stiffness_n_m2()[segment];
        let link_m = link_m[segment];
        (stiffness_n_m2 / link_m, 0.5 * link_m * params.rest_bend_rad()[segment] / params.pitch_m()[segment])
    };
    let count = params.disk_count() * links;
    let sides = [place.checked_sub(1), (place < count).then_some(place)].map(|link| link.map(half));
    match sides {
        [Some((before_nm, before_rad)), Some((behind_nm, behind_rad))] => {
            let is_one = before_nm.to_bits() == behind_nm.to_bits();
            let both_nm = if is_one { before_nm } else { 2.0 / (1.0 / before_nm + 1.0 / behind_nm) };
            (both_nm, before_rad + behind_rad)
        }
        [Some((stiffness_nm, rest_rad)), None] | [None, Some((stiffness_nm, rest_rad))] => {
            (2.0 * stiffness_nm, rest_rad)
        }
        [None, None] => (0.0, 0.0),
    }
}

fn unit(angle_rad: f64) -> Vector2<f64> {
    Vector2::new(libm::cos(angle_rad), libm::sin(angle_rad))
}

/// Returns the unit vector that is a quarter turn ahead of [`unit`], which is also the derivative of [`unit`].
fn normal(angle_rad: f64) -> Vector2<f64> {
    Vector2::new(-libm::sin(angle_rad), libm::cos(angle_rad))
}

#[cfg(test)]
#[allow(clippy::cast_precision_loss, reason = "small numbers")]
mod tests {
    use fric_tendon::ManipulatorOptions;

    use super::*;

    fn bent() -> (Elastica, [Vec<f64>; 2]) {
        let options = ManipulatorOptions {
            pitch_m: &[0.05, 0.03, 0.045, 0.035, 0.02, 0.046, 0.03, 0.04],
            gravity_m_per_s2: [-2.0, -9.0],
            tip_force_n: [0.02, 0.05],
            ..ManipulatorOptions::published()
        };
        let mut elastica = Elastica::new(&ManipulatorParams::new(&options).unwrap(), 5);
        for (place, angle) in elastica.angle_rad.iter_mut().enumerate() {
            *angle = 0.03 * place as f64 + 0.01 * ((place * place) as f64).sin();
        }
        (elastica, [(0..8).map(|place| 1.0 - 0.05 * f64::from(place)).collect(), vec![0.3; 8]])
    }

    #[test]
    fn derivatives_are_those_of_the_energy() {
        let (mut elastica, tension_n) = bent();
        let tension_n = [&tension_n[0][..], &tension_n[1][..]];
        let gradient = elastica.derivatives(tension_n);
        let size = gradient.len();
        // The product of the Hessian with unit vectors, through its factor: H⁻¹(dg) must return the unit vector.
        let shift = 1.0;
        let factor = elastica.hessian.factor(shift).unwrap();
        for place in [0, 3, 4, 5, 17, size - 2, size - 1] {
            let step = 1e-6;
            let begin = elastica.angle_rad[place];
            let mut at = |angle: f64| {
                elastica.angle_rad[place] = angle;
                (elastica.energy_nm(tension_n), elastica.derivatives(tension_n))
            };
            let (more_nm, more) = at(begin + step);
            let (less_nm, less) = at(begin - step);
            elastica.angle_rad[place] = begin;
            assert!(((more_nm - less_nm) / (2.0 * step) - gradient[place]).abs() < 1e-8);
            let mut column: Vec<f64> =
                more.iter().zip(&less).map(|(more, less)| (more - less) / (2.0 * step)).collect();
            column[place] += shift;
            factor.solve(&mut column);
            for (other, value) in column.iter().enumerate() {
                assert!((value - f64::from(other == place)).abs() < 1e-6, "{place} {other} {value}");
            }
        }
    }

    #[test]
    fn compliance_is_that_of_the_minimum() {
        let (mut elastica, mut tension_n) = bent();
        let factor = elastica.settle([&tension_n[0], &tension_n[1]]).unwrap();
        let compliance = elastica.compliance(&factor, 1.0);
        let before: Vec<f64> = (0..8).map(|segment| elastica.strand(segment, 1.0).length_m).collect();
        tension_n[0][2] += 1e-5;
        elastica.settle([&tension_n[0], &tension_n[1]]).unwrap();
        for segment in 0..8 {
            let change = (elastica.strand(segment, 1.0).length_m - before[segment]) / 1e-5;
            assert!((change - compliance[2][segment]).abs() < 1e-6, "{segment}");
        }
    }

    #[test]
    fn a_stepped_and_curved_backbone_is_that_of_the_formula() {
        // Without load it is an arc. A small transverse force F deflects a cantilever of two stiffnesses, with EI_1 in the half at the base, by
        // F/3·((L³ − (L/2)³)/EI_1 + (L/2)³/EI_2).
        let published = ManipulatorOptions { disk_mass_kg: 0.0, ..ManipulatorOptions::published() };
        let settled = |options: &ManipulatorOptions<'_>| {
            let mut elastica = Elastica::new(&ManipulatorParams::new(options).unwrap(), 40);
            elastica.settle([&[], &[]]).unwrap();
            (elastica.disk_position_m()[7], elastica.bend_rad())
        };
        let ([x_m, y_m], bend_rad) = settled(&ManipulatorOptions { precurvature_per_m: &[2.0], ..published });
        let expected_rad = 2.0 * 0.296_f64;
        assert!((bend_rad - expected_rad).abs() < 1e-9);
        assert!((x_m - expected_rad.sin() / 2.0).abs() < 1e-6 && (y_m - (1.0 - expected_rad.cos()) / 2.0).abs() < 1e-6);
        let ratio = [1.0, 1.0, 1.0, 1.0, 0.5, 0.5, 0.5, 0.5];
        let ([_, y_m], _) =
            settled(&ManipulatorOptions { segment_stiffness_ratio: &ratio, tip_force_n: [0.0, 1e-4], ..published });
        let (whole, half) = (0.296_f64.powi(3), 0.148_f64.powi(3));
        let expected_m = 1e-4 / 3.0 * ((whole - half) / 2.7e-3 + half / 1.35e-3);
        assert!((y_m / expected_m - 1.0).abs() < 1e-4, "{y_m} {expected_m}");
    }

    #[test]
    fn unequal_segments_do_not_change_a_uniform_beam() {
        // Precurvature and a tip force act on the backbone alone, so that the shape does not depend on where the disks are; the backbone's weight
        // is the same too.
        let settled = |pitch_m: &[f64]| {
            let options = ManipulatorOptions {
                pitch_m,
                disk_mass_kg: 0.0,
                precurvature_per_m: &[2.0],
                gravity_m_per_s2: [-1.0, 3.0],
                tip_force_n: [0.01, -0.02],
                ..ManipulatorOptions::published()
            };
            let mut elastica = Elastica::new(&ManipulatorParams::new(&options).unwrap(), 60);
            elastica.settle([&[], &[]]).unwrap();
            (elastica.disk_position_m()[7], elastica.bend_rad())
        };
        let (tip_m, bend_rad) = settled(&[0.05, 0.03, 0.045, 0.035, 0.02, 0.046, 0.03, 0.04]);
        let (uniform_tip_m, uniform_rad) = settled(&[0.037]);
        let distance_m = (tip_m[0] - uniform_tip_m[0]).hypot(tip_m[1] - uniform_tip_m[1]);
        assert!(distance_m < 1e-5, "{tip_m:?} {uniform_tip_m:?}");
        assert!((bend_rad - uniform_rad).abs() < 1e-5);
    }

    #[test]
    fn a_cantilever_sags_by_the_formula() {
        // wL⁴/(8EI) for a small transverse weight, and FL³/(3EI).
        let published = ManipulatorOptions { disk_mass_kg: 0.0, ..ManipulatorOptions::published() };
        let sag = |options: &ManipulatorOptions<'_>, links: usize| {
            let mut elastica = Elastica::new(&ManipulatorParams::new(options).unwrap(), links);
            elastica.settle([&[], &[]]).unwrap();
            elastica.disk_position_m()[7][1]
        };
        let weight = sag(&ManipulatorOptions { gravity_m_per_s2: [0.0, 0.01], ..published }, 40);
        let expected = published.backbone_mass_kg_per_m * 0.01 * 0.296_f64.powi(4) / (8.0 * 2.7e-3);
        assert!((weight / expected - 1.0).abs() < 1e-4, "{weight} {expected}");
        let tip = sag(&ManipulatorOptions { tip_force_n: [0.0, 1e-4], ..published }, 40);
        let expected = 1e-4 * 0.296_f64.powi(3) / (3.0 * 2.7e-3);
        assert!((tip / expected - 1.0).abs() < 1e-4, "{tip} {expected}");
    }
}
