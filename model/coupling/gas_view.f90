!> What parcels read of the gas, in the cells that the parcels of this rank touch.
module gas_view
  use gas, only: gas_t
  use kinds, only: wp
  use mapping, only: lanes
  use open_weights, only: open_weights_t
  use spreading, only: spreading_t
  use transfer, only: transfer_t
  implicit none
  private
  public :: gas_view_t, eps_lane, velocity_lane, gradient_lane, density_lane

  !> Components of the field: void fraction, velocity [m/s], pressure gradient [Pa/m], density [kg/m3].
  integer, parameter :: eps_lane = 1, velocity_lane = 2, gradient_lane = 5, density_lane = 8

  type :: gas_view_t
    real(wp), allocatable :: field(:,:)  !< (lanes,window cells)
    logical :: complete = .false.        !< whether `see` has filled it since the window was made
    real(wp), allocatable, private :: eps(:)           !< (window cells)
    real(wp), allocatable, private :: box(:,:,:,:)     !< (lanes,n1,n2,n3) of the cells of my box
    real(wp), allocatable, private :: vector(:,:,:,:)  !< (3,n1,n2,n3)
  contains
    procedure :: create
    procedure :: follow
    procedure :: see
    procedure :: see_void_fraction
  end type gas_view_t

contains

  subroutine create(self, n)
    class(gas_view_t), intent(inout) :: self
    integer, intent(in) :: n(3)  !< cells of my box

    allocate (self%box(lanes, n(1), n(2), n(3)), source=0.0_wp)
    allocate (self%vector(3, n(1), n(2), n(3)), source=0.0_wp)
  end subroutine create

  !> For a new window, in which nothing is known.
  subroutine follow(self, cells)
    class(gas_view_t), intent(inout) :: self
    integer, intent(in) :: cells  !< of the window

    if (allocated(self%field)) deallocate (self%field, self%eps)
    allocate (self%field(lanes, cells), self%eps(cells), source=0.0_wp)
    self%complete = .false.
  end subroutine follow

  !> Bring the gas, as it now is, to the ranks of the parcels. All ranks take part.
  subroutine see(self, gas, weights, spreading, transfer)
    class(gas_view_t), intent(inout) :: self
    type(gas_t), intent(in) :: gas
    type(open_weights_t), allocatable, intent(in) :: weights      !< if walls block the gas
    type(spreading_t), allocatable, intent(inout) :: spreading    !< if parcels see more cells than those they touch
    type(transfer_t), intent(inout) :: transfer

    associate (n => shape(self%box(1, :, :, :)))
      self%box(eps_lane, :, :, :) = gas%eps(1:n(1), 1:n(2), 1:n(3))
      call gas%cell_velocity(self%vector)
      self%box(velocity_lane:velocity_lane + 2, :, :, :) = self%vector
      call gas%cell_pressure_gradient(self%vector)
      self%box(gradient_lane:gradient_lane + 2, :, :, :) = self%vector
      if (allocated(gas%ideal)) self%box(density_lane, :, :, :) = gas%ideal%density(1:n(1), 1:n(2), 1:n(3))
    end associate
    if (allocated(weights)) call weights%narrow(self%box)
    if (allocated(spreading)) call spreading%take(lanes, self%box)
    call transfer%gather(lanes, self%box, self%field)
    self%complete = .true.
  end subroutine see

  !> The same of the void fraction alone, where it is not spread: to the last digit what `see` brings.
  subroutine see_void_fraction(self, gas, weights, transfer)
    class(gas_view_t), intent(inout) :: self
    type(gas_t), intent(in) :: gas
    type(open_weights_t), allocatable, intent(in) :: weights
    type(transfer_t), intent(inout) :: transfer

    real(wp) :: eps(1, size(self%box, 2), size(self%box, 3), size(self%box, 4))

    eps(1, :, :, :) = gas%eps(1:size(eps, 2), 1:size(eps, 3), 1:size(eps, 4))
    if (allocated(weights)) call weights%narrow(eps)
    call transfer%gather(1, eps, self%eps)
    self%field(eps_lane, :) = self%eps
  end subroutine see_void_fraction

end module gas_view
