//! [`Each`] replaces `array::map` on short arrays, to save compile time.
//!
//! The version of the standard library goes through five generic functions for each closure: a
//! tenth of the library's compile time.

/// Arrays of 2, 3, 4, 6 and 8 items.
pub(crate) trait Each<T> {
    type Of<U>;

    /// Returns the array of the results of a function, in order.
    fn each<U>(self, f: impl FnMut(T) -> U) -> Self::Of<U>;
}

macro_rules! lengths {
    ($($n:literal: $($x:ident)*;)*) => {$(
        impl<T> Each<T> for [T; $n] {
            type Of<U> = [U; $n];

            #[inline(always)]
            fn each<U>(self, mut f: impl FnMut(T) -> U) -> [U; $n] {
                let [$($x),*] = self;
                [$(f($x)),*]
            }
        }
    )*};
}

lengths! {
    2: a b;
    3: a b c;
    4: a b c d;
    6: a b c d x y;
    8: a b c d x y z w;
}
