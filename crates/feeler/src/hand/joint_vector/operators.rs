//! Operators of [`JointVector`].

use super::JointVector;
use std::ops::{
    Add, AddAssign, Div, DivAssign, Index, IndexMut, Mul, MulAssign, Neg, Sub, SubAssign,
};

/// Value of a joint, or 0 if it is missing. Panics if the index is [`MAX_JOINTS`](super::MAX_JOINTS) or more.
impl Index<usize> for JointVector {
    type Output = f64;

    #[inline(always)]
    fn index(&self, joint: usize) -> &f64 {
        &self.values[joint]
    }
}

/// Value of a joint. Panics if it is missing.
impl IndexMut<usize> for JointVector {
    #[inline(always)]
    fn index_mut(&mut self, joint: usize) -> &mut f64 {
        let len = self.len();
        &mut self.values[..len][joint]
    }
}

impl Neg for JointVector {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|v| -v)
    }
}

impl Mul<JointVector> for f64 {
    type Output = JointVector;

    #[inline(always)]
    fn mul(self, vector: JointVector) -> JointVector {
        vector.map(|v| self * v)
    }
}

/// Implements element-wise operators between two vectors.
macro_rules! by_joint {
    ($($operator:ident $method:ident $assign:ident $assign_method:ident $op:tt;)*) => {$(
        impl $operator for JointVector {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip_with(other, |a, b| a $op b)
            }
        }

        impl $assign for JointVector {
            #[inline(always)]
            fn $assign_method(&mut self, other: Self) {
                *self = *self $op other;
            }
        }
    )*};
}

/// Implements operators between a vector and a scalar.
macro_rules! by_number {
    ($($operator:ident $method:ident $assign:ident $assign_method:ident $op:tt;)*) => {$(
        impl $operator<f64> for JointVector {
            type Output = Self;

            #[inline(always)]
            fn $method(self, number: f64) -> Self {
                self.map(|v| v $op number)
            }
        }

        impl $assign<f64> for JointVector {
            #[inline(always)]
            fn $assign_method(&mut self, number: f64) {
                *self = *self $op number;
            }
        }
    )*};
}

by_joint! {
    Add add AddAssign add_assign +;
    Sub sub SubAssign sub_assign -;
    Mul mul MulAssign mul_assign *;
    Div div DivAssign div_assign /;
}

by_number! {
    Add add AddAssign add_assign +;
    Sub sub SubAssign sub_assign -;
    Mul mul MulAssign mul_assign *;
    Div div DivAssign div_assign /;
}
