//! Questions on top of a step: all pairs within a distance, the nearest bodies, the first contact.
