/* Refuses a measurement that is not finite or whose quaternion is no attitude. */
static @name@_status check_measurement(const double error[4], const double rate_rad_s[3])
{
    double norm;
    if ((all_finite(error, 4) == 0) || (all_finite(rate_rad_s, 3) == 0)) {
        return @NAME@_HELD_MEASUREMENT_NOT_FINITE;
    }
    norm = sqrt((error[0] * error[0]) + sum_of_products(&error[1], &error[1], 3));
    if (!(fabs(norm - 1.0) <= 1e-2)) {
        return @NAME@_HELD_NOT_UNIT_QUATERNION;
    }
    return @NAME@_NOMINAL;
}
