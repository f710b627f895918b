//! [`Each`]: a function of every item of a short array, as `array::map`. The standard library's
//! version passes through five generic functions for each closure, which took a tenth of the time
//! to compile the library; the answers have the same bits.

/// Arrays of the lengths that points, triangles and tetrahedra have.
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
