!> What an engineer asks of a bed: its pressure drop, its weight, its height.
!>
!> Up is against gravity, along the axis in which gravity is largest.
module bed
  use boxes, only: boxes_t
  use communicator, only: communicator_t
  use kinds, only: wp
  implicit none
  private
  public :: bed_t, up_axis, pressure_drop, bed_heights

  integer, parameter :: bins = 1000           !< of the height, for the share of mass below it
  real(wp), parameter :: share_below = 0.95_wp  !< of the mass, which defines the bed's height

  type :: bed_t
    real(wp) :: pressure_drop = 0    !< of the gas, from the lowest face to the highest [Pa]
    real(wp) :: weight_per_area = 0  !< of all parcels over the cross-section [Pa]
    real(wp) :: height = 0           !< below which 95 % of the mass lies [m]
    real(wp) :: mean_height = 0      !< of the mass [m]
  end type bed_t

contains

  !> The axis that is up, negative where up points to lower coordinates; 2 without gravity.
  pure function up_axis(gravity) result(axis)
    real(wp), intent(in) :: gravity(3)  !< [m/s2]
    integer :: axis

    axis = 2
    if (.not. any(abs(gravity) > 0)) return
    axis = maxloc(abs(gravity), dim=1)
    if (gravity(axis) > 0) axis = -axis
  end function up_axis

  !> Pressure at the lowest face minus that at the highest, each extrapolated from the two layers of
  !> cells next to it [Pa].
  function pressure_drop(boxes, up, pressure, open) result(drop)
    type(boxes_t), intent(in) :: boxes
    integer, intent(in) :: up                         !< see up_axis
    real(wp), intent(in) :: pressure(-1:, -1:, -1:)   !< of the cells of my box, with two layers of halo [Pa]
    real(wp), intent(in), optional :: open(-1:, -1:, -1:)  !< part of the cells by which they count [-]
    real(wp) :: drop

    real(wp) :: layer(boxes%cells(abs(up))), whole(boxes%cells(abs(up)))
    integer :: a, i, last

    a = abs(up)
    last = boxes%cells(a)
    layer = 0
    do i = 1, boxes%n(a)
      if (.not. present(open)) layer(boxes%lo(a) + i - 1) = layer_sum(pressure, boxes%n, a, i)
      if (present(open)) layer(boxes%lo(a) + i - 1) = layer_sum(open*pressure, boxes%n, a, i)
    end do
    layer = boxes%comm%sum(layer)
    whole = product(real(boxes%cells, wp))/last
    if (present(open)) then
      whole = 0
      do i = 1, boxes%n(a)
        whole(boxes%lo(a) + i - 1) = layer_sum(open, boxes%n, a, i)
      end do
      whole = boxes%comm%sum(whole)
    end if
    where (whole > 0) layer = layer/whole
    if (last == 1) then
      drop = 0
    else
      drop = 1.5_wp*(layer(1) - layer(last)) - 0.5_wp*(layer(2) - layer(last - 1))
    end if
    if (up < 0) drop = -drop
  end function pressure_drop

  !> Sum of a field over one layer of my box.
  pure function layer_sum(field, n, a, i) result(total)
    real(wp), intent(in) :: field(-1:, -1:, -1:)
    integer, intent(in) :: n(3), a, i  !< cells of the box, axis, place along it
    real(wp) :: total

    select case (a)
    case (1)
      total = sum(field(i, 1:n(2), 1:n(3)))
    case (2)
      total = sum(field(1:n(1), i, 1:n(3)))
    case default
      total = sum(field(1:n(1), 1:n(2), i))
    end select
  end function layer_sum

  !> The height below which 95 % of the mass lies, and the mean height of the mass.
  subroutine bed_heights(comm, lower, upper, up, position, mass, bed)
    type(communicator_t), intent(in) :: comm
    real(wp), intent(in) :: lower(3), upper(3)         !< corners of the domain [m]
    integer, intent(in) :: up                          !< see up_axis
    real(wp), intent(in) :: position(:, :), mass(:)    !< (3,n) [m], (n) [kg], of my parcels
    type(bed_t), intent(inout) :: bed

    real(wp) :: below(bins + 1), extent, z
    integer :: a, i, b

    a = abs(up)
    extent = upper(a) - lower(a)
    below = 0
    do i = 1, size(mass)
      z = merge(position(a, i) - lower(a), upper(a) - position(a, i), up > 0)
      b = min(max(1 + int(z/extent*bins), 1), bins)
      below(b) = below(b) + mass(i)
      below(bins + 1) = below(bins + 1) + mass(i)*z
    end do
    below = comm%sum(below)
    if (sum(below(:bins)) <= 0) return
    bed%mean_height = below(bins + 1)/sum(below(:bins))
    bed%height = quantile(below(:bins), share_below)*extent/bins
  end subroutine bed_heights

  !> The number of bins, with its fraction, that hold the share of the whole.
  pure function quantile(histogram, share) result(place)
    real(wp), intent(in) :: histogram(:), share
    real(wp) :: place

    real(wp) :: wanted, passed
    integer :: b

    wanted = share*sum(histogram)
    passed = 0
    do b = 1, size(histogram)
      if (passed + histogram(b) >= wanted) exit
      passed = passed + histogram(b)
    end do
    b = min(b, size(histogram))
    place = b - 1
    if (histogram(b) > 0) place = place + (wanted - passed)/histogram(b)
  end function quantile

end module bed
