//! `counters!`: a struct of counters that are added to each other as a whole, and whose difference is what was counted
//! in between.

/// Declares a public struct whose fields are numbers, or such structs, with `+=` and `−` over all fields.
macro_rules! counters {
    (
        $(#[$about:meta])*
        pub struct $name:ident { $($(#[$doc:meta])* pub $field:ident: $number:ty,)* }
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct $name { $($(#[$doc])* pub $field: $number,)* }

        impl std::ops::AddAssign for $name {
            fn add_assign(&mut self, other: Self) {
                $(self.$field += other.$field;)*
            }
        }

        impl std::ops::Sub for $name {
            type Output = Self;
            /// Counts since `before`.
            fn sub(self, before: Self) -> Self {
                Self { $($field: self.$field - before.$field,)* }
            }
        }
    };
}
pub(crate) use counters;
