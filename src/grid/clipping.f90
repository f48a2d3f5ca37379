!> The part of a rectangle on which a function is positive, the function piecewise linear between samples.
module clipping
  use kinds, only: wp
  implicit none
  private
  public :: positive_part

contains

  !> Area and first moments of the part of a rectangle on which a function is positive. Each rectangle of the lattice of
  !> samples is four triangles about its middle, where the function is the mean of the corners: so mirror images are equal.
  pure subroutine positive_part(f, extent, area, moment)
    real(wp), intent(in) :: f(0:, 0:)    !< at the points of a lattice, edge to edge
    real(wp), intent(in) :: extent(2)    !< of the rectangle [m]
    real(wp), intent(out) :: area        !< [m2]
    real(wp), intent(out) :: moment(2)   !< about the middle of the rectangle [m3]

    real(wp) :: step(2), corner(2, 0:4), value(0:4), middle(2)
    integer :: i, j, k

    area = 0.0_wp
    moment = 0.0_wp
    step = extent/(shape(f) - 1)
    do j = 0, ubound(f, 2) - 1
      do i = 0, ubound(f, 1) - 1
        middle = step*([i, j] + 0.5_wp) - 0.5_wp*extent
        corner(:, 0) = middle + 0.5_wp*step*[-1, -1]
        corner(:, 1) = middle + 0.5_wp*step*[1, -1]
        corner(:, 2) = middle + 0.5_wp*step
        corner(:, 3) = middle + 0.5_wp*step*[-1, 1]
        corner(:, 4) = corner(:, 0)
        value = [f(i, j), f(i + 1, j), f(i + 1, j + 1), f(i, j + 1), f(i, j)]
        do k = 0, 3
          call add_triangle(reshape([middle, corner(:, k), corner(:, k + 1)], [2, 3]), &
                            [0.25_wp*sum(value(0:3)), value(k), value(k + 1)], area, moment)
        end do
      end do
    end do
  end subroutine positive_part

  !> Add the part of one triangle, whose corners run anticlockwise.
  pure subroutine add_triangle(x, f, area, moment)
    real(wp), intent(in) :: x(2, 3)  !< [m]
    real(wp), intent(in) :: f(3)
    real(wp), intent(inout) :: area, moment(2)

    real(wp) :: polygon(2, 4), piece
    integer :: k, next, n

    n = 0
    do k = 1, 3
      next = modulo(k, 3) + 1
      if (f(k) > 0.0_wp) then
        n = n + 1
        polygon(:, n) = x(:, k)
      end if
      if ((f(k) > 0.0_wp) .eqv. (f(next) > 0.0_wp)) cycle
      n = n + 1
      polygon(:, n) = x(:, k) + f(k)/(f(k) - f(next))*(x(:, next) - x(:, k))
    end do
    do k = 3, n
      piece = 0.5_wp*((polygon(1, k - 1) - polygon(1, 1))*(polygon(2, k) - polygon(2, 1)) &
                      - (polygon(2, k - 1) - polygon(2, 1))*(polygon(1, k) - polygon(1, 1)))
      area = area + piece
      moment = moment + piece/3*(polygon(:, 1) + polygon(:, k - 1) + polygon(:, k))
    end do
  end subroutine add_triangle

end module clipping
