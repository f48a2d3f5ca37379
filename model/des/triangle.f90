!> The nearest point of a triangle.
module triangle
  use kinds, only: wp
  implicit none
  private
  public :: approach_triangle

contains

  !> The way from the nearest point of a triangle to a point, and what of the triangle that is nearest: the corners
  !> that bear it, 0, 0 inside the triangle, k, 0 corner k, k, l between two.
  !>
  !> With x - a in terms of the edges, the sign of each barycentric coordinate tells on which side of an edge the foot of the
  !> perpendicular lies, and its place along the edge which end it is beyond. Source: Ericson, Real-Time Collision Detection,
  !> Morgan Kaufmann 2005, section 5.1.5.
  pure subroutine approach_triangle(shape, x, way, bearers)
    real(wp), intent(in) :: shape(3, 4)  !< corners [m], unit normal
    real(wp), intent(in) :: x(3)         !< [m]
    real(wp), intent(out) :: way(3)      !< [m]
    integer, intent(out) :: bearers(2)

    real(wp) :: ab(3), ac(3), from_a(3), from_b(3), from_c(3)
    real(wp) :: a_b, a_c, b_b, b_c, c_b, c_c  ! way from a corner along the edges ab and ac

    ab = shape(:, 2) - shape(:, 1)
    ac = shape(:, 3) - shape(:, 1)
    from_a = x - shape(:, 1)
    from_b = x - shape(:, 2)
    from_c = x - shape(:, 3)
    a_b = dot_product(ab, from_a)
    a_c = dot_product(ac, from_a)
    b_b = dot_product(ab, from_b)
    b_c = dot_product(ac, from_b)
    c_b = dot_product(ab, from_c)
    c_c = dot_product(ac, from_c)
    if (a_b <= 0.0_wp .and. a_c <= 0.0_wp) then
      way = from_a
      bearers = [1, 0]
    else if (b_b >= 0.0_wp .and. b_c <= b_b) then
      way = from_b
      bearers = [2, 0]
    else if (c_c >= 0.0_wp .and. c_b <= c_c) then
      way = from_c
      bearers = [3, 0]
    else if (a_b*b_c - b_b*a_c <= 0.0_wp .and. a_b >= 0.0_wp .and. b_b <= 0.0_wp) then
      way = from_a - a_b/(a_b - b_b)*ab
      bearers = [1, 2]
    else if (c_b*a_c - a_b*c_c <= 0.0_wp .and. a_c >= 0.0_wp .and. c_c <= 0.0_wp) then
      way = from_a - a_c/(a_c - c_c)*ac
      bearers = [1, 3]
    else if (b_b*c_c - c_b*b_c <= 0.0_wp .and. b_c >= b_b .and. c_b >= c_c) then
      way = from_b - (b_c - b_b)/((b_c - b_b) + (c_b - c_c))*(ac - ab)
      bearers = [2, 3]
    else
      way = dot_product(from_a, shape(:, 4))*shape(:, 4)
      bearers = 0
    end if
  end subroutine approach_triangle

end module triangle
