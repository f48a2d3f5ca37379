!> The gas phase: what the rest of the program sees of it.
!>
!> Before a step the owner sets, on cells 1..n of the box, `eps`, `drag` and `drag_source`; `advance` takes the step;
!> `accept` makes its void fraction the old one. Call `accept` once before the first step as well, when the void
!> fraction of the start is set. Where inflows change in time, `time` is the owner's to set, too.
module gas
  use boundary_settings, only: boundary_settings_t
  use boxes, only: boxes_t
  use eddy_viscosity, only: let_swirl
  use gas_density, only: balance_pressure => balance, let_vary
  use gas_numerics, only: gas_numerics_t
  use gas_settings, only: gas_settings_t
  use gas_state, only: gas_state_t, gas_report_t, create_state, find_density
  use kinds, only: wp
  use mesh, only: mesh_t, unit_step
  use open_space, only: open_space_t
  use outcome, only: outcome_t
  use pressure_solver, only: pace_size
  use simple_step, only: advance_state, restore_state
  implicit none
  private
  public :: gas_t, gas_report_t, new_gas, saved_fields, pace_size

  integer, parameter :: saved_fields = 12  !< per cell, of the state of a gas

  type, extends(gas_state_t) :: gas_t
  contains
    procedure :: balance
    procedure :: advance
    procedure :: accept
    procedure :: reject
    procedure :: cell_velocity
    procedure :: cell_pressure_gradient
    procedure :: drag_total
    procedure :: export_state
    procedure :: import_state
    procedure :: destroy
  end type gas_t

contains

  !> A gas at its initial velocity. The gravity it feels is its public component `gravity`, zero until set.
  !> Mistakes in the records that only the grid shows go into `outcome`, the same on all ranks.
  subroutine new_gas(boxes, mesh, settings, records, numerics, gas, outcome, space)
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    type(gas_settings_t), intent(in) :: settings
    type(boundary_settings_t), intent(in) :: records(:)
    type(gas_numerics_t), intent(in) :: numerics
    type(gas_t), intent(out) :: gas
    type(outcome_t), intent(inout) :: outcome
    type(open_space_t), intent(in), optional :: space  !< that walls leave; all of the domain if not given

    call create_state(boxes, mesh, settings, records, numerics, gas, outcome, space)
    if (outcome%failed()) return
    if (settings%density_law == 'ideal') call let_vary(gas, settings, records)
    if (settings%turbulence_model == 'smagorinsky') call let_swirl(gas, settings%smagorinsky_constant)
  end subroutine new_gas

  !> With the gravity set, before the first step: an ideal gas begins at rest, with the pressure that carries its weight.
  subroutine balance(self)
    class(gas_t), intent(inout) :: self

    if (allocated(self%ideal)) call balance_pressure(self)
  end subroutine balance

  !> One implicit step. Without convergence velocity and pressure are as before.
  subroutine advance(self, dt, converged)
    class(gas_t), intent(inout) :: self
    real(wp), intent(in) :: dt  !< [s]
    logical, intent(out) :: converged

    call advance_state(self, dt, converged)
  end subroutine advance

  !> The present void fraction is that at the start of the next step.
  subroutine accept(self)
    class(gas_t), intent(inout) :: self

    call self%halo%exchange(self%eps)
    self%eps_old = self%eps
  end subroutine accept

  !> Undo the last step, though it converged.
  subroutine reject(self)
    class(gas_t), intent(inout) :: self

    call restore_state(self)
  end subroutine reject

  !> Velocity of the gas in each cell, the mean over the two faces as they share its drag [m/s]: the drag on the gas is
  !> drag_source - drag*cell_velocity exactly.
  pure subroutine cell_velocity(self, velocity)
    class(gas_t), intent(in) :: self
    real(wp), intent(out), contiguous :: velocity(:,:,:,:)  !< (3, cells 1..n)

    integer :: a, i, j, k, e(3)
    real(wp) :: upper

    upper = 0.5_wp
    do a = 1, 3
      e = unit_step(a)
      do k = 1, self%boxes%n(3)
        do j = 1, self%boxes%n(2)
          do i = 1, self%boxes%n(1)
            if (allocated(self%space)) upper = self%space%upper(i, j, k, a)
            velocity(a, i, j, k) = (1 - upper)*self%velocity(i - e(1), j - e(2), k - e(3), a) + upper*self%velocity(i, j, k, a)
          end do
        end do
      end do
    end do
  end subroutine cell_velocity

  !> Pressure gradient in each cell, the mean over its faces that are solved for [Pa/m], 0 along a direction in which
  !> it has none; that of a drop along periodic directions included. The pressure given on an open face is half a cell
  !> away, not a whole one; beyond it the void fraction is 0.
  pure subroutine cell_pressure_gradient(self, gradient)
    class(gas_t), intent(in) :: self
    real(wp), intent(out), contiguous :: gradient(:,:,:,:)  !< (3, cells 1..n)

    integer :: a, i, j, k, m, e(3), x(3), y(3)
    real(wp) :: below, above, here

    do a = 1, 3
      e = unit_step(a)
      do k = 1, self%boxes%n(3)
        do j = 1, self%boxes%n(2)
          do i = 1, self%boxes%n(1)
            x = [i, j, k] - e
            y = [i, j, k] + e
            below = self%free(x(1), x(2), x(3), a)
            above = self%free(i, j, k, a)
            here = self%pressure(i, j, k)
            m = dot_product(e, [i, j, k])
            gradient(a, i, j, k) = &
              below*(1 - 0.5_wp*above)*merge(1, 2, self%eps(x(1), x(2), x(3)) > 0.0_wp) &
                *(here - self%pressure(x(1), x(2), x(3)))/self%spacing(a)%gap(m - 1) &
              + above*(1 - 0.5_wp*below)*merge(1, 2, self%eps(y(1), y(2), y(3)) > 0.0_wp) &
                *(self%pressure(y(1), y(2), y(3)) - here)/self%spacing(a)%gap(m) &
              - self%driving%drop(a)/(self%mesh%upper(a) - self%mesh%lower(a))
          end do
        end do
      end do
    end do
  end subroutine cell_pressure_gradient

  !> Force of the drag on the gas, over all ranks, half of each cell's on each of its two faces, or by their open areas
  !> where walls block the gas [N]. What falls on faces whose velocity is given is borne by the boundary.
  function drag_total(self) result(force)
    class(gas_t), intent(in) :: self
    real(wp) :: force(3)

    integer :: a, i, j, k, e(3)
    real(wp) :: upper

    upper = 0.5_wp
    force = 0.0_wp
    do a = 1, 3
      e = unit_step(a)
      do k = 1, self%boxes%n(3)
        do j = 1, self%boxes%n(2)
          do i = 1, self%boxes%n(1)
            if (allocated(self%space)) upper = self%space%upper(i, j, k, a)
            associate (source => self%drag_source(a, i, j, k), coefficient => self%drag(i, j, k))
              force(a) = force(a) + (1 - upper)*(source - coefficient*self%velocity(i - e(1), j - e(2), k - e(3), a)) &
                                  + upper*(source - coefficient*self%velocity(i, j, k, a))
            end associate
          end do
        end do
      end do
    end do
    force = self%boxes%comm%sum(force)
  end function drag_total

  !> Everything a run needs to go on from here: upper face velocities (1:3), pressure (4), old void fraction (5),
  !> the velocities on the low surface of the domain (6:8) and the matrix of multigrid (9:12). Independent of how the grid is cut
  !> into boxes.
  subroutine export_state(self, fields, pace)
    class(gas_t), intent(in) :: self
    real(wp), intent(out), contiguous :: fields(:,:,:,:)  !< (saved_fields, cells 1..n)
    real(wp), intent(out) :: pace(pace_size)              !< of multigrid, see pressure_solver

    integer :: a
    real(wp), allocatable :: matrix(:,:,:,:)

    fields = 0.0_wp
    associate (n => self%boxes%n, u => self%velocity)
      do a = 1, 3
        fields(a, :, :, :) = u(1:n(1), 1:n(2), 1:n(3), a)
      end do
      fields(4, :, :, :) = self%pressure(1:n(1), 1:n(2), 1:n(3))
      fields(5, :, :, :) = self%eps_old(1:n(1), 1:n(2), 1:n(3))
      if (self%boxes%at_low(1)) fields(6, 1, :, :) = u(0, 1:n(2), 1:n(3), 1)
      if (self%boxes%at_low(2)) fields(7, :, 1, :) = u(1:n(1), 0, 1:n(3), 2)
      if (self%boxes%at_low(3)) fields(8, :, :, 1) = u(1:n(1), 1:n(2), 0, 3)
    end associate
    allocate (matrix(size(fields, 2), size(fields, 3), size(fields, 4), 4))
    call self%solver%export_state(matrix, pace)
    do a = 1, 4
      fields(8 + a, :, :, :) = matrix(:, :, :, a)
    end do
  end subroutine export_state

  !> The reverse; `eps`, `drag` and `drag_source` are inputs of the next step and set by their owner.
  subroutine import_state(self, fields, pace)
    class(gas_t), intent(inout) :: self
    real(wp), intent(in), contiguous :: fields(:,:,:,:)
    real(wp), intent(in) :: pace(pace_size)

    integer :: a
    real(wp), allocatable :: matrix(:,:,:,:)

    associate (n => self%boxes%n)
      do a = 1, 3
        self%velocity(1:n(1), 1:n(2), 1:n(3), a) = fields(a, :, :, :)
      end do
      self%pressure(1:n(1), 1:n(2), 1:n(3)) = fields(4, :, :, :)
      self%eps(1:n(1), 1:n(2), 1:n(3)) = fields(5, :, :, :)
      if (self%boxes%at_low(1)) self%velocity(0, 1:n(2), 1:n(3), 1) = fields(6, 1, :, :)
      if (self%boxes%at_low(2)) self%velocity(1:n(1), 0, 1:n(3), 2) = fields(7, :, 1, :)
      if (self%boxes%at_low(3)) self%velocity(1:n(1), 1:n(2), 0, 3) = fields(8, :, :, 1)
    end associate
    allocate (matrix(size(fields, 2), size(fields, 3), size(fields, 4), 4))
    do a = 1, 4
      matrix(:, :, :, a) = fields(8 + a, :, :, :)
    end do
    call self%solver%import_state(matrix, pace)
    call self%halo%exchange(self%pressure)
    call self%halo%exchange_many(self%velocity)
    if (allocated(self%ideal)) call find_density(self)
    call self%accept()
  end subroutine import_state

  !> Give back what libraries hold; before MPI ends.
  subroutine destroy(self)
    class(gas_t), intent(inout) :: self

    call self%solver%destroy()
  end subroutine destroy

end module gas
