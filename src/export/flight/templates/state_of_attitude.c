/* The state: rate, then the vector part of the quaternion whose scalar part is not negative. */
static void read_state(const double error[4], const double rate_rad_s[3], double state[STATES])
{
    const double sign = (error[0] < 0.0) ? -1.0 : 1.0;
    int axis;
    for (axis = 0; axis < 3; ++axis) {
        state[axis] = rate_rad_s[axis];
        state[3 + axis] = sign * error[1 + axis];
    }
}
