!> The weights of parcels in cells that walls leave open in part.
!>
!> A cell counts by its open part phi_c: the weights are phi_c w_c/N with N = sum of phi_c w_c, w_c those of the mapping and,
!> if there is one, of the spreading. So a field is multiplied by phi before it is taken and by 1/N after, and an amount by
!> 1/N before it is given and by phi after: what the gas gets is what the parcels give.
module open_weights
  use kinds, only: wp
  use mapping, only: interpolate_amount
  use open_space, only: open_space_t
  use spreading, only: spreading_t
  use transfer, only: transfer_t
  use window, only: window_t
  implicit none
  private
  public :: open_weights_t

  type :: open_weights_t
    real(wp), allocatable :: open(:,:,:)  !< (n1,n2,n3) phi of the cells of my box
    real(wp), allocatable :: around(:)    !< (window cells) what parcels see of it
    real(wp), allocatable :: share(:)     !< (parcels) 1/N, 0 where no cell around is open
  contains
    procedure :: create
    procedure :: see
    procedure :: find_shares
    procedure :: narrow
  end type open_weights_t

contains

  pure subroutine create(self, n, space)
    class(open_weights_t), intent(inout) :: self
    integer, intent(in) :: n(3)  !< cells of my box
    type(open_space_t), intent(in) :: space

    allocate (self%open(n(1), n(2), n(3)), source=space%volume(1:n(1), 1:n(2), 1:n(3)))
    allocate (self%share(0))
  end subroutine create

  !> Bring the open part of the cells to where parcels are; all ranks together.
  subroutine see(self, spreading, transfer, window)
    class(open_weights_t), intent(inout) :: self
    type(spreading_t), allocatable, intent(inout) :: spreading
    type(transfer_t), intent(inout) :: transfer
    type(window_t), intent(in) :: window

    real(wp) :: field(size(self%open, 1), size(self%open, 2), size(self%open, 3))

    field = self%open
    if (allocated(spreading)) call spreading%take(1, field)
    if (allocated(self%around)) deallocate (self%around)
    allocate (self%around(window%cells()), source=0.0_wp)
    call transfer%gather(1, field, self%around)
  end subroutine see

  !> 1/N of parcels.
  pure subroutine find_shares(self, window, corner, fraction)
    class(open_weights_t), intent(inout) :: self
    type(window_t), intent(in) :: window
    integer, intent(in) :: corner(:)       !< (n) places, see mapping
    real(wp), intent(in) :: fraction(:,:)  !< (3,n)

    real(wp) :: sum_of_weights(size(corner))

    call interpolate_amount(window, corner, fraction, self%around, sum_of_weights)
    deallocate (self%share)
    allocate (self%share(size(corner)), source=0.0_wp)
    where (sum_of_weights > 0.0_wp) self%share = 1/sum_of_weights
  end subroutine find_shares

  !> Multiply the components of a field by phi.
  pure subroutine narrow(self, field)
    class(open_weights_t), intent(in) :: self
    real(wp), intent(inout) :: field(:,:,:,:)  !< (components,n1,n2,n3)

    integer :: c

    do c = 1, size(field, 1)
      field(c, :, :, :) = self%open*field(c, :, :, :)
    end do
  end subroutine narrow

end module open_weights
