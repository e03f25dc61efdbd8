//! The steps of a transform.

use super::ranges::{direction, in_range, point};
use crate::math::{DMat3, DVec3, Transform};
use crate::scene::text::{Choice, Fields, Spanned, Value, spanned};

/// A step: `{ scale = 2 }`, `{ rotate = { axis = [0, 1, 0], degrees = 30 } }`, `{ translate = [0, 1, 0] }`, or
/// `{ matrix = [[2, 0, 0, 0], [0, 2, 0, 1], [0, 0, 2, 0], [0, 0, 0, 1]] }`, which multiplies column vectors.
#[derive(Clone, Copy)]
pub(super) enum Step {
    /// A factor for each axis.
    Scale(DVec3),
    /// A rotation.
    Rotate(Transform),
    /// A translation.
    Translate(DVec3),
    /// Any of these, one after another.
    Matrix(Transform),
}

const STEP: Choice<for<'d> fn(Value<'d>) -> Option<Step>> = Choice {
    name: "a step of a transform",
    word: "step of a transform",
    example: "{ translate = [0, 1, 0] }",
    second_kind_help: "write one step after the other: [{ scale = 2 }, { translate = [0, 1, 0] }]",
    outside_keys: &[],
    kinds: &[
        ("scale", |value| {
            let factors = in_range(value, "a scale", value.one_or("[x, y, z]")?)?;
            Some(Step::Scale(factors.into()))
        }),
        ("rotate", |value| {
            Fields::read(value, |turn| {
                let axis = turn.need("axis", direction);
                let finite = f64::MIN..=f64::MAX;
                let degrees =
                    turn.need("degrees", |value| value.number_within(finite, "an angle is a finite number", None));
                Some(Step::Rotate(Transform::rotate(axis?, degrees?)))
            })
        }),
        ("translate", |value| point(value).map(Step::Translate)),
        ("matrix", |value| matrix(value).map(Step::Matrix)),
    ],
};

/// Reads four rows of four numbers. The last row must be 0, 0, 0, 1.
fn matrix(value: Value) -> Option<Transform> {
    let help = "write four rows of four numbers, the last of them [0, 0, 0, 1]";
    let row = |row: Value| in_range(row, "an entry of a matrix", row.as_list("a row of a matrix", help).numbers()?);
    if value.node().as_array().is_none_or(|rows| rows.len() != 4) {
        return value.advise("a matrix is a list of 4 rows", help);
    }
    let rows: [[f64; 4]; 4] = value.array(row)?;
    let column = |i: usize| DVec3::new(rows[0][i], rows[1][i], rows[2][i]);
    let last = [0.0, 0.0, 0.0, 1.0];
    match rows[3] == last {
        true => Some(Transform::affine(DMat3::from_cols(column(0), column(1), column(2)), column(3))),
        false if column(3) == DVec3::ZERO && rows[3][3] == 1.0 => value.advise(
            "this matrix has its translation in the last row",
            "transpose it: the translation is the last column",
        ),
        false => value.entry(3).advise("the last row of a matrix is [0, 0, 0, 1]", help),
    }
}

/// Reads a list of steps.
pub(super) fn steps(value: Value) -> Option<Vec<Spanned<Step>>> {
    value.list(spanned(|step| {
        let (read, kind) = STEP.of(step)?;
        read(kind)
    }))
}

/// Returns the map of the steps, one after another, applied after a first map.
pub(super) fn compose_steps(steps: &[Spanned<Step>], first: Transform) -> Option<Transform> {
    steps.iter().try_fold(first, |map, Spanned { place, value: step }| {
        let next = match *step {
            Step::Scale(factors) => Transform::scale(factors),
            Step::Rotate(map) | Step::Matrix(map) => map,
            Step::Translate(by) => Transform::translate(by),
        };
        let map = map.then(&next);
        match map.is_invertible() {
            true => Some(map),
            false => place.refuse("this step flattens the shape or sends it to infinity"),
        }
    })
}
