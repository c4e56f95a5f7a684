//! Layer 2: geometry.
