//! How robots and their bodies stand in registers: all that tells one robot from several in the recursion.
//!
//! A group of the plan has two bodies (a left and a right limb). [`Pairwise`] keeps both of one robot in one register.
//! [`Abreast`] has a register for each, with as many robots side by side as fit in. Every number is the outcome of the same
//! operations in the same order in both, so that a robot's results are the same bits.

use super::articulated::BaseWork;
use super::slot::{Slot, Spatial};
use crate::robot::model::{BASE_FREEDOMS, Group, Parent};
use crate::robot::spatial::{Articulated, Number, Pair, Two, Vec3, Widest, add, six, three};

/// Most robots in a register.
pub(super) const MOST_ROBOTS: usize = 4;

/// Numbers of the joints, robot by robot; a layout of fewer robots looks at the first only.
pub(super) type Rows<'a> = [&'a [f64]; MOST_ROBOTS];

/// The rows of robots.
#[inline(always)]
pub(super) fn rows<'a>(joints: usize, of: impl Fn(usize) -> &'a [f64]) -> Rows<'a> {
    [&of(0)[..joints], &of(1)[..joints], &of(2)[..joints], &of(3)[..joints]]
}

/// What a group hands to its parent.
#[derive(Clone, Copy)]
pub(super) struct Handed<N> {
    pub inertia: Articulated<N>,
    pub moment: Vec3<N>,
    pub force: Vec3<N>,
}

impl<N: Number> Handed<N> {
    /// Nothing.
    pub fn zero() -> Self {
        Self { inertia: Articulated::zero(), moment: [N::zero(); 3], force: [N::zero(); 3] }
    }

    /// Adds a share of this to inertia and bias.
    #[inline(always)]
    fn to(&self, inertia: &mut Articulated<N>, bias: &mut Spatial<N>, share: impl Fn(N) -> N) {
        inertia.zip(&self.inertia, |x, y| x + share(y));
        bias.0 = three(|i| bias.0[i] + share(self.moment[i]));
        bias.1 = three(|i| bias.1[i] + share(self.force[i]));
    }
}

/// See the module.
pub(super) trait Layout: Sized {
    /// Numbers of bodies.
    type Number: Number;
    /// Numbers of robots.
    type Single: Number;
    /// Most registers that the bodies of a group take, each a part.
    const PARTS: usize;

    /// Registers that the bodies of a group take.
    fn parts(group: &Group) -> usize;

    /// A constant of a group.
    fn constant(two: &Two, part: usize) -> Self::Number;

    /// A vector of constants.
    #[inline(always)]
    fn vector(v: &Vec3<Two>, part: usize) -> Vec3<Self::Number> {
        three(|i| Self::constant(&v[i], part))
    }

    /// A matrix of constants.
    #[inline(always)]
    fn matrix(m: &[Vec3<Two>; 3], part: usize) -> [Vec3<Self::Number>; 3] {
        three(|i| Self::vector(&m[i], part))
    }

    /// A symmetric matrix of constants.
    #[inline(always)]
    fn symmetric(m: &[Two; 6], part: usize) -> [Self::Number; 6] {
        six(|k| Self::constant(&m[k], part))
    }

    /// A spatial inertia of constants.
    #[inline(always)]
    fn inertia(m: &Articulated<Two>, part: usize) -> Articulated<Self::Number> {
        Articulated { a: Self::symmetric(&m.a, part), b: Self::matrix(&m.b, part), c: Self::symmetric(&m.c, part) }
    }

    /// The same for all bodies of a robot.
    fn of_robot(single: Self::Single) -> Self::Number;

    /// A number of the base, which is the first body of two.
    fn first(single: Self::Single) -> [Self::Number; 2];

    /// Sum over both bodies.
    fn total(parts: [Self::Number; 2]) -> Self::Single;

    /// A number of each of a group's joints.
    fn of_joints(group: &Group, part: usize, rows: &Rows<'_>) -> Self::Number;

    /// Writes a number of each of a group's joints into the robots' generalised accelerations, which stand one after another.
    fn write(group: &Group, part: usize, number: Self::Number, out: &mut [f64], freedoms: usize);

    /// What the parents have of something.
    fn above(
        group: &Group,
        part: usize,
        slots: &[Slot<Self::Number>],
        base: &Spatial<Self::Number>,
        of: impl Fn(&Slot<Self::Number>) -> Spatial<Self::Number>,
    ) -> Spatial<Self::Number>;

    /// Gives to the parents what the bodies hand to them; `kept` remembers the first part for the second.
    fn give(
        group: &Group,
        part: usize,
        handed: Handed<Self::Number>,
        kept: &mut Handed<Self::Number>,
        earlier: &mut [Slot<Self::Number>],
        base: &mut BaseWork<Self>,
    );
}

/// One robot: two of its bodies in a register.
pub(super) struct Pairwise;

impl Layout for Pairwise {
    type Number = Pair;
    type Single = f64;
    const PARTS: usize = 1;

    #[inline(always)]
    fn parts(_group: &Group) -> usize {
        1
    }

    #[inline(always)]
    fn constant(two: &Two, _part: usize) -> Pair {
        two.pair()
    }

    #[inline(always)]
    fn of_robot(single: f64) -> Pair {
        Pair::splat(single)
    }

    #[inline(always)]
    fn first(single: f64) -> [Pair; 2] {
        [Pair::new(single, 0.0), Pair::zero()]
    }

    #[inline(always)]
    fn total([both, _]: [Pair; 2]) -> f64 {
        both.sum()
    }

    #[inline(always)]
    fn of_joints(group: &Group, _part: usize, rows: &Rows<'_>) -> Pair {
        group.of_joints(rows[0])
    }

    #[inline(always)]
    fn write(group: &Group, _part: usize, number: Pair, out: &mut [f64], _freedoms: usize) {
        let [first, second] = number.lanes();
        out[BASE_FREEDOMS + group.joints[1]] = second;
        out[BASE_FREEDOMS + group.joints[0]] = first;
    }

    #[inline(always)]
    fn above(group: &Group, _part: usize, slots: &[Slot], base: &Spatial, of: impl Fn(&Slot) -> Spatial) -> Spatial {
        match group.parent {
            Parent::Base => *base,
            Parent::Lanes(above) => of(&slots[above]),
            Parent::Shared { group, lane, .. } => {
                let (angular, linear) = of(&slots[group]);
                let one = |x: Pair| Pair::splat(x.lanes()[lane]);
                (angular.map(one), linear.map(one))
            }
        }
    }

    #[inline(always)]
    fn give(
        group: &Group,
        _part: usize,
        handed: Handed<Pair>,
        _kept: &mut Handed<Pair>,
        earlier: &mut [Slot],
        base: &mut BaseWork<Self>,
    ) {
        match group.parent {
            Parent::Lanes(above) => handed.to(&mut earlier[above].inertia, &mut earlier[above].bias, |x| x),
            Parent::Base => handed.to(&mut base.inertia[0], &mut base.bias[0], |x| x * group.counts.pair()),
            Parent::Shared { group: above, mask, .. } => {
                let summed = |x: Pair| mask.pair() * Pair::splat((x * group.counts.pair()).sum());
                handed.to(&mut earlier[above].inertia, &mut earlier[above].bias, summed);
            }
        }
    }
}

#[inline(always)]
fn splat(value: f64) -> Widest {
    crate::number::Lanes::splat(value)
}

/// As many robots as a register has lanes, one body of each.
pub(super) struct Abreast;

impl Layout for Abreast {
    type Number = Widest;
    type Single = Widest;
    const PARTS: usize = 2;

    #[inline(always)]
    fn parts(group: &Group) -> usize {
        2 - usize::from(group.is_single)
    }

    #[inline(always)]
    fn constant(two: &Two, part: usize) -> Widest {
        splat(two.0[part])
    }

    #[inline(always)]
    fn of_robot(single: Widest) -> Widest {
        single
    }

    #[inline(always)]
    fn first(single: Widest) -> [Widest; 2] {
        [single, Widest::zero()]
    }

    #[inline(always)]
    fn total([first, second]: [Widest; 2]) -> Widest {
        first + second
    }

    #[inline(always)]
    fn of_joints(group: &Group, part: usize, rows: &Rows<'_>) -> Widest {
        Widest::of(|robot| rows[robot][group.joints[part]])
    }

    #[inline(always)]
    fn write(group: &Group, part: usize, number: Widest, out: &mut [f64], freedoms: usize) {
        for (out, number) in out.chunks_exact_mut(freedoms).zip(number.each()) {
            out[BASE_FREEDOMS + group.joints[part]] = number;
        }
    }

    #[inline(always)]
    fn above(
        group: &Group,
        part: usize,
        slots: &[Slot<Widest>],
        base: &Spatial<Widest>,
        of: impl Fn(&Slot<Widest>) -> Spatial<Widest>,
    ) -> Spatial<Widest> {
        match group.parent {
            Parent::Base => *base,
            Parent::Lanes(above) => of(&slots[2 * above + part]),
            Parent::Shared { group, lane, .. } => of(&slots[2 * group + lane]),
        }
    }

    #[inline(always)]
    fn give(
        group: &Group,
        part: usize,
        handed: Handed<Widest>,
        kept: &mut Handed<Widest>,
        earlier: &mut [Slot<Widest>],
        base: &mut BaseWork<Self>,
    ) {
        match group.parent {
            Parent::Lanes(above) => {
                let above = &mut earlier[2 * above + part];
                handed.to(&mut above.inertia, &mut above.bias, |x| x);
            }
            Parent::Base => {
                handed.to(&mut base.inertia[part], &mut base.bias[part], |x| x);
                if group.is_single {
                    // As a pair does with the lane that repeats the other: it may turn -0 into 0.
                    handed.to(&mut base.inertia[1], &mut base.bias[1], |x| x * Widest::zero());
                }
            }
            Parent::Shared { .. } if part == 0 && !group.is_single => *kept = handed,
            Parent::Shared { group: above, mask, .. } => {
                let mut sum = handed;
                if part == 1 {
                    sum.inertia.zip(&kept.inertia, |second, first| first + second);
                    (sum.moment, sum.force) = (add(kept.moment, sum.moment), add(kept.force, sum.force));
                }
                for (above, share) in earlier[2 * above..].iter_mut().zip(mask.0) {
                    let share = splat(share);
                    sum.to(&mut above.inertia, &mut above.bias, |x| share * x);
                }
            }
        }
    }
}
