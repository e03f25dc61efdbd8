//! The steps of a transform.

use super::measures::{direction, near, point};
use crate::math::{DVec3, Transform};
use crate::scene::text::{At, Choice, Fields, Value, at};

/// One step: `{ scale = 2 }`, `{ rotate = { axis = [0, 1, 0], degrees = 30 } }`, `{ translate = [0, 1, 0] }`.
#[derive(Clone, Copy)]
pub(super) enum Step {
    /// A factor for each axis.
    Scale(DVec3),
    /// A turn.
    Rotate(Transform),
    /// A shift.
    Translate(DVec3),
}

const STEP: Choice<for<'d> fn(Value<'d>) -> Option<Step>> = Choice {
    name: "a step of a transform",
    word: "step of a transform",
    example: "{ translate = [0, 1, 0] }",
    apart: "write one step after the other: [{ scale = 2 }, { translate = [0, 1, 0] }]",
    beside: &[],
    kinds: &[
        ("scale", |value| {
            let factors = near(value, "a scale", value.one_or("[x, y, z]")?)?;
            Some(Step::Scale(factors.into()))
        }),
        ("rotate", |value| {
            Fields::read(value, |turn| {
                let axis = turn.need("axis", direction);
                let finite = f64::MIN..=f64::MAX;
                let degrees = turn.need("degrees", |value| value.within(finite, "an angle is a finite number", None));
                Some(Step::Rotate(Transform::rotate(axis?, degrees?)))
            })
        }),
        ("translate", |value| point(value).map(Step::Translate)),
    ],
};

/// The steps of a list.
pub(super) fn steps(value: Value) -> Option<Vec<At<Step>>> {
    value.list(at(|step| {
        let (read, kind) = STEP.of(step)?;
        read(kind)
    }))
}

/// The map that steps make, one after another, behind a first one.
pub(super) fn map_of(steps: &[At<Step>], first: Transform) -> Option<Transform> {
    steps.iter().try_fold(first, |map, At { place, it: step }| {
        let next = match *step {
            Step::Scale(factors) => Transform::scale(factors),
            Step::Rotate(turn) => turn,
            Step::Translate(by) => Transform::translate(by),
        };
        let map = map.then(&next);
        match map.is_invertible() {
            true => Some(map),
            false => place.refuse("this step flattens the shape or sends it to infinity"),
        }
    })
}
