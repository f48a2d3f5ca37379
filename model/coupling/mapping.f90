!> The one mapping between parcels and gas cells, used for volume, drag and gas velocity alike.
!>
!> A parcel shares itself among the eight cells whose centres surround it by trilinear weights
!>
!>   w_c = prod over x, y, z of (1 - |s - s_c|),     sum over c of w_c = 1,
!>
!> with the places s of the parcel and s_c of the centre counted in cells (module grid_axis).
!> Within half a cell of a wall the centre beyond the wall is missing: the place is moved to the nearest
!> centre, so that the weights still sum to one and a parcel's whole volume stays in the gas. The width of the
!> mapping is that of the cells, whatever the size or the weight of the parcel. Because the same weights spread the
!> drag over the cells and take the gas velocity from them, what the gas receives is what the parcels give.
!>
!> With mapping = 'cell' fractions are rounded, which leaves the one cell a parcel is in. Module spreading widens either.
!>
!> A place is kept as the lowest of the eight cells and the three fractions of a cell beyond its centre.
module mapping
  use kinds, only: wp
  use mesh, only: mesh_t
  use window, only: window_t
  implicit none
  private
  public :: locate, interpolate, interpolate_sources, interpolate_amount, deposit, deposit_sources
  public :: lanes, source_lanes, mapping_variance

  integer, parameter :: lanes = 8         !< components of a field to interpolate: one line of cache
  integer, parameter :: source_lanes = 4  !< components of a source to deposit, or of what is known of sizes

contains

  !> Mean square distance of a parcel from the centres of its cells in one direction, by their weights, over the width of
  !> a cell squared, in the mean over all places: that of f (1 - f) for f in [0, 1], or of f^2 for f in [-1/2, 1/2].
  pure function mapping_variance(name) result(variance)
    character(len=*), intent(in) :: name  !< 'linear' | 'cell'
    real(wp) :: variance                  !< [-]

    variance = merge(1.0_wp/12.0_wp, 1.0_wp/6.0_wp, name == 'cell')
  end function mapping_variance

  !> The places of parcels. `outside` counts those beyond the window and those whose position is no number.
  pure subroutine locate(mesh, window, position, corner, fraction, outside)
    type(mesh_t), intent(in) :: mesh
    type(window_t), intent(in) :: window
    real(wp), intent(in) :: position(:,:)     !< (3 or more,n) the first three rows are the position [m]
    integer, intent(inout) :: corner(:)       !< (n) lowest of the eight cells, counted in the window from 1
    real(wp), intent(inout) :: fraction(:,:)  !< (3,n) [-]
    integer, intent(out) :: outside

    integer :: i, cell(3)
    real(wp), dimension(3) :: s, inverse_h, origin, lowest, highest

    ! Cell c of the grid has its centre at s = c - lo, so s runs over the window from 0.
    inverse_h = 1.0_wp/mesh%coarsest
    origin = 0.5_wp - window%lo
    lowest = 0.0_wp
    highest = real(window%n - 1, wp)
    where (.not. window%periodic) highest = real(min(window%hi, window%grid) - window%lo, wp)
    outside = 0
    do i = 1, size(corner)
      if (mesh%uniform) then
        s = (position(1:3, i) - mesh%lower)*inverse_h + origin
      else
        s = mesh%in_cells(position(1:3, i)) + origin
      end if
      if (any(window%periodic .and. .not. (s >= lowest .and. s <= highest)) .or. .not. abs(sum(s)) <= huge(s)) then
        outside = outside + 1
        s = lowest
      end if
      s = min(max(s, lowest), highest)
      cell = min(int(s), window%n - 2)
      fraction(:, i) = s - cell
      corner(i) = 1 + cell(1) + window%n(1)*(cell(2) + window%n(2)*cell(3))
    end do
  end subroutine locate

  !> The eight weights of a place, x fastest.
  pure function weights(fraction) result(w)
    real(wp), intent(in) :: fraction(3)
    real(wp) :: w(8)

    real(wp) :: x(2), plane(4)

    x = [1.0_wp - fraction(1), fraction(1)]
    plane = [x*(1.0_wp - fraction(2)), x*fraction(2)]
    w = [plane*(1.0_wp - fraction(3)), plane*fraction(3)]
  end function weights

  !> How far the eight cells lie behind the lowest of them, in the order of the weights.
  pure function steps(window) result(step)
    type(window_t), intent(in) :: window
    integer :: step(8)

    integer :: row, plane

    row = window%n(1)
    plane = row*window%n(2)
    step = [0, 1, row, row + 1, plane, plane + 1, plane + row, plane + row + 1]
  end function steps

  !> The values of a field at the places.
  pure subroutine interpolate(window, corner, fraction, field, value)
    type(window_t), intent(in) :: window
    integer, intent(in) :: corner(:)                      !< (n)
    real(wp), intent(in) :: fraction(:,:)                 !< (3,n)
    real(wp), intent(in) :: field(lanes, window%cells())  !< any unit
    real(wp), intent(inout) :: value(lanes, size(corner))

    integer :: i, k, step(8)
    real(wp) :: w(8), total(lanes)

    step = steps(window)
    do i = 1, size(corner)
      w = weights(fraction(:, i))
      total = 0.0_wp
      do k = 1, 8
        total = total + w(k)*field(:, corner(i) + step(k))
      end do
      value(:, i) = total
    end do
  end subroutine interpolate

  !> The same for the components of a source.
  pure subroutine interpolate_sources(window, corner, fraction, field, value)
    type(window_t), intent(in) :: window
    integer, intent(in) :: corner(:)                             !< (n)
    real(wp), intent(in) :: fraction(:,:)                        !< (3,n)
    real(wp), intent(in) :: field(source_lanes, window%cells())  !< any unit
    real(wp), intent(inout) :: value(source_lanes, size(corner))

    integer :: i, k, step(8)
    real(wp) :: w(8), total(source_lanes)

    step = steps(window)
    do i = 1, size(corner)
      w = weights(fraction(:, i))
      total = 0.0_wp
      do k = 1, 8
        total = total + w(k)*field(:, corner(i) + step(k))
      end do
      value(:, i) = total
    end do
  end subroutine interpolate_sources

  !> The same for a field of one component.
  pure subroutine interpolate_amount(window, corner, fraction, field, value)
    type(window_t), intent(in) :: window
    integer, intent(in) :: corner(:)               !< (n)
    real(wp), intent(in) :: fraction(:,:)          !< (3,n)
    real(wp), intent(in) :: field(window%cells())  !< any unit
    real(wp), intent(out) :: value(:)              !< (n)

    integer :: i

    do i = 1, size(corner)
      value(i) = sum(weights(fraction(:, i))*field(corner(i) + steps(window)))
    end do
  end subroutine interpolate_amount

  !> Share an amount of each place among its cells.
  pure subroutine deposit(window, corner, fraction, amount, field)
    type(window_t), intent(in) :: window
    integer, intent(in) :: corner(:)               !< (n)
    real(wp), intent(in) :: fraction(:,:)          !< (3,n)
    real(wp), intent(in) :: amount(:)              !< (n) any unit
    real(wp), intent(inout) :: field(window%cells())

    integer :: i, k, step(8)
    real(wp) :: w(8)

    step = steps(window)
    do i = 1, size(corner)
      w = weights(fraction(:, i))*amount(i)
      do k = 1, 8
        field(corner(i) + step(k)) = field(corner(i) + step(k)) + w(k)
      end do
    end do
  end subroutine deposit

  !> The same for several components at once.
  pure subroutine deposit_sources(window, corner, fraction, amount, field)
    type(window_t), intent(in) :: window
    integer, intent(in) :: corner(:)                             !< (n)
    real(wp), intent(in) :: fraction(:,:)                        !< (3,n)
    real(wp), intent(in) :: amount(source_lanes, size(corner))   !< any unit
    real(wp), intent(inout) :: field(source_lanes, window%cells())

    integer :: i, k, step(8)
    real(wp) :: w(8)

    step = steps(window)
    do i = 1, size(corner)
      w = weights(fraction(:, i))
      do k = 1, 8
        field(:, corner(i) + step(k)) = field(:, corner(i) + step(k)) + w(k)*amount(:, i)
      end do
    end do
  end subroutine deposit_sources

end module mapping
