//! The linearised equations along the manipulator, solved from the tip to the base in a time proportional to the number of segments.
//!
//! The part beyond a hole acts on the part before it through three numbers only: the displacement of each tendon through the hole, and the change of
//! the moment of the weight beyond. These depend on four numbers only: the tension of each tendon before the hole, the bend of the segment before it,
//! and the sum of the bends before it. So each segment is eliminated by a system of three equations, once from the tip to the base; the way back to
//! the tip gives the solution.
//!
//! The part of a manipulator beyond a hole is in equilibrium itself, so its equations have a solution wherever those of a stable manipulator have
//! one. If there is none, or a number is not finite, [`Chain::eliminate`] reports it.

use super::newton::Point;

/// Number of unknowns of a segment: its bend, and the tension of each tendon.
const UNKNOWNS: usize = 3;
/// A number as a linear function of the quantities before a segment: a constant, then the slopes with respect to the tensions of both tendons in the
/// segment before, the bend of that segment, and the sum of all bends before.
type Affine = [f64; 5];
/// The same, preceded by `UNKNOWNS` slopes.
type Row = [f64; 8];

/// The equation of a segment's bend θ_i:
///
/// `own·θ_i − Σ_t by_tension_t·T_{t,i} − compliance·(load_slope·Σ_{j<i} θ_j + Σ_{j>i} load_slope_j·θ_j) = right`.
#[derive(Clone, Copy, Debug, Default)]
pub struct BendRow {
    pub own: f64,
    pub by_tension: [f64; 2],
    pub compliance: f64,
    /// Change of the moment of weight and tip load on a segment with a bend nearer to the base, and vice versa.
    pub load_slope: f64,
    pub right: f64,
}

/// The equation of the tension T_i behind a hole:
///
/// `base_side·T_{i−1} + tip_side·T_i + wrap·(θ_{i−1} + θ_i) + motion·s_i = right` with the displacement of the tendon through the hole, `s_i =
/// Σ_{j≥i} (way_by_bend_j·θ_j + way_by_tension_j·T_j)`.
#[derive(Clone, Copy, Debug)]
pub struct HoleRow {
    pub base_side: f64,
    pub tip_side: f64,
    pub wrap: f64,
    pub motion: f64,
    pub way_by_bend: f64,
    pub way_by_tension: f64,
    pub right: f64,
}

impl HoleRow {
    /// The equation of a constant tension.
    pub const KNOWN: Self = Self {
        base_side: 0.0,
        tip_side: 1.0,
        wrap: 0.0,
        motion: 0.0,
        way_by_bend: 0.0,
        way_by_tension: 0.0,
        right: 0.0,
    };
}

/// The equations of a segment and of the holes at its beginning.
#[derive(Clone, Copy, Debug)]
pub struct Link {
    pub bend: BendRow,
    pub holes: [HoleRow; 2],
}

impl Link {
    const EMPTY: Self = Self {
        bend: BendRow { own: 1.0, by_tension: [0.0; 2], compliance: 1.0, load_slope: 0.0, right: 0.0 },
        holes: [HoleRow::KNOWN; 2],
    };
}

/// The equations of a whole manipulator, with space for their solution.
#[derive(Clone, Debug)]
pub struct Chain<const DISKS: usize> {
    pub links: [Link; DISKS],
    /// The unknowns of each segment as functions of the quantities before it.
    unknowns: [[Affine; UNKNOWNS]; DISKS],
}

impl<const DISKS: usize> Chain<DISKS> {
    pub const fn new() -> Self {
        Self { links: [Link::EMPTY; DISKS], unknowns: [[[0.0; 5]; UNKNOWNS]; DISKS] }
    }

    /// Eliminates the first `count` segments from the tip to the base. Returns `false` if an equation has no solution or a number is not finite.
    #[must_use]
    pub fn eliminate(&mut self, count: usize) -> bool {
        let mut beyond = Beyond::NOTHING;
        for (link, unknowns) in self.links.iter().zip(&mut self.unknowns).take(count).rev() {
            match beyond.segment(link) {
                Some(found) => *unknowns = found,
                None => return false,
            }
            beyond = beyond.with(link, unknowns);
        }
        true
    }

    /// Returns the solution as a step, after [`eliminate`](Self::eliminate).
    pub fn solution(&self, count: usize) -> Point<DISKS> {
        self.along(count, 1.0, [0.0; 2])
    }

    /// Returns the effect of a change of the base tensions, N, after [`eliminate`](Self::eliminate).
    pub fn by_base_tension(&self, count: usize, change_n: [f64; 2]) -> Point<DISKS> {
        self.along(count, 0.0, change_n)
    }

    fn along(&self, count: usize, constant: f64, base_n: [f64; 2]) -> Point<DISKS> {
        let mut step = Point::ZERO;
        let [first_n, second_n] = &mut step.tension_n;
        let [mut first_before_n, mut second_before_n] = base_n;
        let (mut before_rad, mut sum_rad) = (0.0, 0.0);
        let values = step.bend_rad.iter_mut().zip(first_n.iter_mut().zip(second_n));
        for ((bend_rad, (first_n, second_n)), unknowns) in values.zip(&self.unknowns).take(count) {
            let at = |[value, by_first, by_second, by_bend, by_sum]: &Affine| {
                constant * value
                    + by_first * first_before_n
                    + by_second * second_before_n
                    + by_bend * before_rad
                    + by_sum * sum_rad
            };
            let [bend, first, second] = unknowns;
            (*bend_rad, *first_n, *second_n) = (at(bend), at(first), at(second));
            (before_rad, first_before_n, second_before_n) = (*bend_rad, *first_n, *second_n);
            sum_rad += *bend_rad;
        }
        step
    }

    /// Whether the stiffness of the bends at constant tensions is positive definite: the second derivative of the energy, with `own/compliance` on
    /// the diagonal and, beside it, `−load_slope` of the segment nearer to the tip.
    pub fn is_stiff(&self, count: usize) -> bool {
        let mut taken = 0.0;
        for link in self.links.iter().take(count).rev() {
            let BendRow { own, compliance, load_slope, .. } = link.bend;
            let pivot = own / compliance - taken;
            if !(pivot > 0.0 && pivot < f64::INFINITY) {
                return false;
            }
            // The remaining off-diagonal entry is the same for all segments nearer to the base.
            let beside = load_slope + taken;
            taken += beside * beside / pivot;
        }
        true
    }
}

/// The part beyond a segment, as functions of the tensions in the segment, its bend, and the sum of the bends up to it.
#[derive(Clone, Copy, Debug)]
struct Beyond {
    /// Displacement of each tendon through the next hole.
    ways: [Affine; 2],
    /// `Σ load_slope_j·θ_j` over the segments beyond.
    load: Affine,
}

impl Beyond {
    const NOTHING: Self = Self { ways: [[0.0; 5]; 2], load: [0.0; 5] };

    /// Returns the unknowns of a segment as functions of the quantities before it.
    fn segment(&self, link: &Link) -> Option<[Affine; UNKNOWNS]> {
        let BendRow { own, by_tension: [by_first, by_second], compliance, load_slope, right } = link.bend;
        let [constant, first, second, bend, sum] = self.load.map(|value| compliance * value);
        let bend_row: Row = [
            own - bend - sum,
            -by_first - first,
            -by_second - second,
            right + constant,
            0.0,
            0.0,
            0.0,
            compliance * load_slope + sum,
        ];
        let [first_hole, second_hole] = link.holes;
        let [first_way, second_way] = self.ways;
        let [constant, first, second, bend, sum] = first_way.map(|value| first_hole.motion * value);
        let first_row: Row = [
            first_hole.wrap + first_hole.motion * first_hole.way_by_bend + bend + sum,
            first_hole.tip_side + first_hole.motion * first_hole.way_by_tension + first,
            second,
            first_hole.right - constant,
            -first_hole.base_side,
            0.0,
            -first_hole.wrap,
            -sum,
        ];
        let [constant, first, second, bend, sum] = second_way.map(|value| second_hole.motion * value);
        let second_row: Row = [
            second_hole.wrap + second_hole.motion * second_hole.way_by_bend + bend + sum,
            first,
            second_hole.tip_side + second_hole.motion * second_hole.way_by_tension + second,
            second_hole.right - constant,
            0.0,
            -second_hole.base_side,
            -second_hole.wrap,
            -sum,
        ];
        solve(bend_row, first_row, second_row)
    }

    /// Returns the part including a segment whose unknowns are known functions of the quantities before it.
    fn with(&self, link: &Link, [bend, first, second]: &[Affine; UNKNOWNS]) -> Self {
        let [first_hole, second_hole] = link.holes;
        let through = |affine: &Affine, [own_bend, own_first, own_second]: [f64; 3]| {
            let [constant, by_first, by_second, by_bend, by_sum] = *affine;
            let (by_bend, by_first, by_second) =
                (by_bend + by_sum + own_bend, by_first + own_first, by_second + own_second);
            let mut sum = [constant, 0.0, 0.0, 0.0, by_sum];
            for (sum, (bend, (first, second))) in sum.iter_mut().zip(bend.iter().zip(first.iter().zip(second))) {
                *sum += by_bend * bend + by_first * first + by_second * second;
            }
            sum
        };
        let [first_way, second_way] = &self.ways;
        Self {
            ways: [
                through(first_way, [first_hole.way_by_bend, first_hole.way_by_tension, 0.0]),
                through(second_way, [second_hole.way_by_bend, 0.0, second_hole.way_by_tension]),
            ],
            load: through(&self.load, [link.bend.load_slope, 0.0, 0.0]),
        }
    }
}

/// Solves three equations for their first three numbers, by elimination with row pivoting; `None` if the matrix is singular or not finite.
fn solve(mut one: Row, mut two: Row, mut three: Row) -> Option<[Affine; UNKNOWNS]> {
    let is_pivot = |value: f64| value.abs() > 1e-280 && value.abs() < f64::INFINITY;
    let reduce = |row: &mut Row, factor: f64, by: &Row| {
        for (value, by) in row.iter_mut().zip(by) {
            *value -= factor * by;
        }
    };
    if two[0].abs() > one[0].abs() {
        core::mem::swap(&mut one, &mut two);
    }
    if three[0].abs() > one[0].abs() {
        core::mem::swap(&mut one, &mut three);
    }
    if !is_pivot(one[0]) {
        return None;
    }
    for row in [&mut two, &mut three] {
        let factor = row[0] / one[0];
        reduce(row, factor, &one);
    }
    if three[1].abs() > two[1].abs() {
        core::mem::swap(&mut two, &mut three);
    }
    if !is_pivot(two[1]) {
        return None;
    }
    let factor = three[1] / two[1];
    reduce(&mut three, factor, &two);
    if !is_pivot(three[2]) {
        return None;
    }
    let tail = |[_, _, _, rest @ ..]: Row, divisor: f64| rest.map(|value| value / divisor);
    let second = tail(three, three[2]);
    let mut first = tail(two, 1.0);
    for (first, second) in first.iter_mut().zip(second) {
        *first = (*first - two[2] * second) / two[1];
    }
    let mut bend = tail(one, 1.0);
    for (bend, (first, second)) in bend.iter_mut().zip(first.into_iter().zip(second)) {
        *bend = (*bend - one[1] * first - one[2] * second) / one[0];
    }
    let is_finite = [bend, first, second].iter().flatten().all(|value| value.is_finite());
    is_finite.then_some([bend, first, second])
}

#[cfg(test)]
mod tests {
    use nalgebra::{SMatrix, SVector};

    use super::*;

    const COUNT: usize = 4;

    /// Returns pseudo-random numbers of the order of one.
    fn number(place: usize) -> f64 {
        let place = u32::try_from(place).unwrap();
        libm::sin(f64::from(place * place) + 0.3)
    }

    fn chain() -> Chain<6> {
        let mut chain = Chain::new();
        for (segment, link) in chain.links.iter_mut().enumerate().take(COUNT) {
            let value = |place: usize| number(20 * segment + place);
            link.bend = BendRow {
                own: 3.0 + value(0),
                by_tension: [value(1), value(2)],
                compliance: 1.5 + 0.2 * value(3),
                load_slope: 0.2 * value(4),
                right: value(5),
            };
            link.holes = [6, 13].map(|first| HoleRow {
                base_side: 1.0 + 0.1 * value(first),
                tip_side: -1.0 + 0.1 * value(first + 1),
                wrap: 0.3 * value(first + 2),
                motion: -2.0 - value(first + 3),
                way_by_bend: 0.5 + 0.1 * value(first + 4),
                way_by_tension: 0.2 + 0.1 * value(first + 5),
                right: value(first + 6),
            });
        }
        chain
    }

    /// Returns the same equations as one matrix: bends, tensions of the first and of the second tendon.
    fn dense(chain: &Chain<6>) -> (SMatrix<f64, 12, 12>, SVector<f64, 12>) {
        let (mut matrix, mut right) = (SMatrix::zeros(), SVector::zeros());
        for (row, Link { bend, holes }) in chain.links.iter().enumerate().take(COUNT) {
            right[row] = bend.right;
            matrix[(row, row)] = bend.own;
            for (tendon, by_tension) in bend.by_tension.iter().enumerate() {
                matrix[(row, COUNT * (tendon + 1) + row)] = -by_tension;
            }
            for other in (0..COUNT).filter(|other| *other != row) {
                matrix[(row, other)] = -bend.compliance * chain.links[row.max(other)].bend.load_slope;
            }
            for (tendon, hole) in holes.iter().enumerate() {
                let first = COUNT * (tendon + 1);
                right[first + row] = hole.right;
                matrix[(first + row, first + row)] += hole.tip_side;
                matrix[(first + row, row)] += hole.wrap;
                if row > 0 {
                    matrix[(first + row, first + row - 1)] += hole.base_side;
                    matrix[(first + row, row - 1)] += hole.wrap;
                }
                for beyond in row..COUNT {
                    let way = chain.links[beyond].holes[tendon];
                    matrix[(first + row, beyond)] += hole.motion * way.way_by_bend;
                    matrix[(first + row, first + beyond)] += hole.motion * way.way_by_tension;
                }
            }
        }
        (matrix, right)
    }

    fn as_vector(step: &Point<6>) -> SVector<f64, 12> {
        let [first, second] = &step.tension_n;
        SVector::from_iterator([&step.bend_rad, first, second].into_iter().flat_map(|all| all[..COUNT].to_vec()))
    }

    #[test]
    fn solves_as_the_whole_matrix_does() {
        let mut chain = chain();
        let (matrix, mut right) = dense(&chain);
        assert!(chain.eliminate(COUNT));
        let expected = matrix.lu().solve(&right).unwrap();
        assert!((as_vector(&chain.solution(COUNT)) - expected).norm() < 1e-12);
        // A change at the base enters the right-hand side of the first holes.
        right.fill(0.0);
        let change_n = [0.7, -0.4];
        for (tendon, change_n) in change_n.into_iter().enumerate() {
            right[COUNT * (tendon + 1)] = -chain.links[0].holes[tendon].base_side * change_n;
        }
        let expected = matrix.lu().solve(&right).unwrap();
        assert!((as_vector(&chain.by_base_tension(COUNT, change_n)) - expected).norm() < 1e-12);
    }

    #[test]
    fn knows_what_has_no_solution() {
        let mut singular = chain();
        singular.links[2] = Link { bend: BendRow { own: 0.0, ..BendRow::default() }, holes: [HoleRow::KNOWN; 2] };
        singular.links[3].bend.load_slope = 0.0;
        assert!(!singular.eliminate(COUNT));
        let mut broken = chain();
        broken.links[1].holes[0].wrap = f64::NAN;
        assert!(!broken.eliminate(COUNT));
    }

    #[test]
    fn definite_as_the_eigenvalues_say() {
        let (mut stiff_count, mut cases) = (0, 0);
        for case in 0..60 {
            let mut chain = Chain::<6>::new();
            let mut stiffness = SMatrix::<f64, COUNT, COUNT>::zeros();
            for (segment, link) in chain.links.iter_mut().enumerate().take(COUNT) {
                link.bend.compliance = 0.7;
                link.bend.own = 0.7 * (1.0 + 0.6 * number(9 * case + segment));
                link.bend.load_slope = 0.6 * number(9 * case + segment + 4);
                stiffness[(segment, segment)] = link.bend.own / 0.7;
                for nearer in 0..segment {
                    stiffness[(segment, nearer)] = -link.bend.load_slope;
                    stiffness[(nearer, segment)] = -link.bend.load_slope;
                }
            }
            let is_definite = stiffness.symmetric_eigenvalues().min() > 0.0;
            assert_eq!(chain.is_stiff(COUNT), is_definite, "case {case}");
            stiff_count += u32::from(is_definite);
            cases += 1;
        }
        assert!(stiff_count > 5 && stiff_count < cases - 5, "{stiff_count} of {cases}");
    }
}
