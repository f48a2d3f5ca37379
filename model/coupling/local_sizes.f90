!> How large the particles around each parcel are.
!>
!>   <d> = M_0/M_-1,    S = M_1 M_-1/M_0^2,    M_k = sum over parcels of w_c W V d^k
!>
!> <d> is the Sauter mean, S = sum of x_k d_k/<d> over the sizes with their shares x_k of the solids' volume, 1 if there is one
!> size only. The moments are spread over the cells by the weights of module mapping, as the volume is, and taken from there by
!> the same weights: cells count by their solids, empty ones not at all.
module local_sizes
  use boxes, only: boxes_t
  use constants, only: pi
  use kinds, only: wp
  use mapping, only: deposit_sources, interpolate_sources, source_lanes
  use parcels, only: parcels_t
  use spreading, only: spreading_t
  use transfer, only: transfer_t
  use window, only: window_t
  implicit none
  private
  public :: local_sizes_t

  integer, parameter :: block = 64  !< parcels treated together

  !> The lanes are M_0, M_-1 and M_1; sources have a fourth, which is empty.
  type :: local_sizes_t
    private
    real(wp), allocatable :: box(:,:,:,:)       !< (source_lanes,n1,n2,n3) [m3, m2, m4]
    real(wp), allocatable :: cells(:,:)         !< (source_lanes,window cells)
    real(wp), allocatable, public :: mean(:)    !< (parcels or more) <d> [m]
    real(wp), allocatable, public :: spread(:)  !< (parcels or more) S [-]
  contains
    procedure :: create
    procedure :: measure
  end type local_sizes_t

contains

  subroutine create(self, boxes)
    class(local_sizes_t), intent(inout) :: self
    type(boxes_t), intent(in) :: boxes

    associate (n => boxes%n)
      allocate (self%box(source_lanes, n(1), n(2), n(3)), source=0.0_wp)
    end associate
    allocate (self%cells(source_lanes, 0), self%mean(0), self%spread(0))
  end subroutine create

  !> Find <d> and S at parcels whose places are known; all ranks together.
  subroutine measure(self, window, transfer, parcels, corner, fraction, spreading)
    class(local_sizes_t), intent(inout) :: self
    type(window_t), intent(in) :: window
    type(transfer_t), intent(inout) :: transfer
    type(parcels_t), intent(in) :: parcels
    integer, intent(in) :: corner(:)        !< (parcels) and
    real(wp), intent(in) :: fraction(:,:)   !< (3,parcels) the places, see mapping
    type(spreading_t), intent(inout), optional :: spreading  !< of what is given and taken

    real(wp) :: moment(source_lanes, block)
    integer :: first, last, i

    call reserve(self, size(corner), window%cells())
    moment = 0.0_wp
    do first = 1, size(corner), block
      last = min(size(corner), first + block - 1)
      do i = first, last
        associate (d => parcels%diameter(i))
          moment(1:3, i - first + 1) = pi/6.0_wp*parcels%weight(i)*d**2*[d, 1.0_wp, d**2]
        end associate
      end do
      call deposit_sources(window, corner(first:last), fraction(:, first:last), moment(:, :last - first + 1), self%cells)
    end do
    self%box = 0.0_wp
    call transfer%scatter_add(source_lanes, self%cells, self%box)
    if (present(spreading)) then
      call spreading%give(source_lanes, self%box)
      call spreading%take(source_lanes, self%box)
    end if
    call transfer%gather(source_lanes, self%box, self%cells)
    do first = 1, size(corner), block
      last = min(size(corner), first + block - 1)
      call interpolate_sources(window, corner(first:last), fraction(:, first:last), self%cells, moment(:, :last - first + 1))
      do i = first, last
        associate (m => moment(:, i - first + 1))
          self%mean(i) = m(1)/m(2)
          self%spread(i) = m(3)*m(2)/m(1)**2
        end associate
      end do
    end do
  end subroutine measure

  !> Room for the parcels, and empty cells.
  pure subroutine reserve(self, parcels, cells)
    class(local_sizes_t), intent(inout) :: self
    integer, intent(in) :: parcels, cells

    if (parcels > size(self%mean)) then
      deallocate (self%mean, self%spread)
      allocate (self%mean(parcels + parcels/4), self%spread(parcels + parcels/4))
    end if
    if (size(self%cells, 2) /= cells) then
      deallocate (self%cells)
      allocate (self%cells(source_lanes, cells))
    end if
    self%cells = 0.0_wp
  end subroutine reserve

end module local_sizes
