static void cross(const double left[3], const double right[3], double out[3])
{
    out[0] = (left[1] * right[2]) - (left[2] * right[1]);
    out[1] = (left[2] * right[0]) - (left[0] * right[2]);
    out[2] = (left[0] * right[1]) - (left[1] * right[0]);
}

/* The inertia times a vector. */
static void momentum_of(const double rate[3], double out[3])
{
    int axis;
    for (axis = 0; axis < 3; ++axis) {
        out[axis] = sum_of_products(INERTIA[axis], rate, 3);
    }
}

/* The quaternion scaled to norm 1. */
static void normalise(const double error[4], double out[4])
{
    const double norm = sqrt((error[0] * error[0]) + sum_of_products(&error[1], &error[1], 3));
    int part;
    for (part = 0; part < 4; ++part) {
        out[part] = error[part] / norm;
    }
}

/* The time derivative of the quaternion at a body rate (rad/s). */
static void derivative(const double error[4], const double rate[3], double out[4])
{
    double turned[3];
    int axis;
    cross(&error[1], rate, turned);
    out[0] = -0.5 * sum_of_products(&error[1], rate, 3);
    for (axis = 0; axis < 3; ++axis) {
        out[1 + axis] = ((rate[axis] * error[0]) + turned[axis]) * 0.5;
    }
}
