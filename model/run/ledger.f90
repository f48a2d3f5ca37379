!> The books of a run: what must not change, how well it did not, and what was spent.
module ledger
  use coupling, only: exchange_t
  use gas, only: gas_report_t
  use kinds, only: wp, i8
  use scene, only: scene_t
  use text, only: shown
  implicit none
  private
  public :: ledger_t, ledger_from, ledger_size

  integer, parameter :: ledger_size = 14  !< numbers that a restart file keeps

  !> Sums and extremes over all steps since the start of the run.
  type :: ledger_t
    real(wp) :: gas_steps = 0, retries = 0
    real(wp) :: iterations = 0, pressure_iterations = 0  !< of the gas
    real(wp) :: solids_steps = 0
    real(wp) :: parcel_steps = 0             !< parcels times solids steps
    real(wp) :: worst_imbalance = 0          !< gas mass of a step that is not accounted for, over the inflow [-]
    real(wp) :: gas_in = 0, gas_out = 0, gas_stored = 0  !< [kg]
    real(wp) :: worst_exchange = 0           !< momentum not balanced between gas and parcels in a step [-]
    real(wp) :: worst_clipping = 0           !< solids the gas did not see, over all solids, in a step [-]
    real(wp) :: least_void_fraction = 1      !< of any cell in any step [-]
    real(wp) :: worst_courant = 0            !< largest |u| dt/h [-]
  contains
    procedure :: enter_step
    procedure :: numbers
    procedure :: print => print_ledger
  end type ledger_t

contains

  !> Enter the step the scene has just done.
  subroutine enter_step(self, scene)
    class(ledger_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene

    self%retries = self%retries + scene%report%retries
    if (scene%with_gas) call enter_gas(self, scene%gas%report, scene%report%dt)
    if (scene%with_parcels) then
      self%solids_steps = self%solids_steps + scene%report%solids_steps
      self%parcel_steps = self%parcel_steps &
        + real(scene%report%solids_steps, wp)*(scene%solids%added - scene%solids%left)
    end if
    if (scene%with_gas .and. scene%with_parcels) call enter_exchange(self, scene%coupling%exchange)
  end subroutine enter_step

  subroutine enter_gas(self, report, dt)
    class(ledger_t), intent(inout) :: self
    type(gas_report_t), intent(in) :: report
    real(wp), intent(in) :: dt  !< [s]

    self%gas_steps = self%gas_steps + 1
    self%iterations = self%iterations + report%iterations
    self%pressure_iterations = self%pressure_iterations + report%pressure_iterations
    self%worst_imbalance = max(self%worst_imbalance, report%mass_imbalance)
    self%gas_in = self%gas_in + dt*report%inflow
    self%gas_out = self%gas_out + dt*report%outflow
    self%gas_stored = self%gas_stored + dt*report%accumulation
    self%worst_courant = max(self%worst_courant, report%courant)
  end subroutine enter_gas

  subroutine enter_exchange(self, exchange)
    class(ledger_t), intent(inout) :: self
    type(exchange_t), intent(in) :: exchange

    self%worst_exchange = max(self%worst_exchange, exchange%momentum_residual)
    self%least_void_fraction = min(self%least_void_fraction, exchange%least_void_fraction)
    if (exchange%solids_volume > 0) then
      self%worst_clipping = max(self%worst_clipping, exchange%clipped_volume/exchange%solids_volume)
    end if
  end subroutine enter_exchange

  !> The books as plain numbers, for a restart file.
  pure function numbers(self)
    class(ledger_t), intent(in) :: self
    real(wp) :: numbers(ledger_size)

    numbers = [self%gas_steps, self%retries, self%iterations, self%pressure_iterations, self%solids_steps, &
      self%parcel_steps, self%worst_imbalance, self%gas_in, self%gas_out, self%gas_stored, self%worst_exchange, &
      self%worst_clipping, self%least_void_fraction, self%worst_courant]
  end function numbers

  !> The books from such numbers.
  pure function ledger_from(numbers) result(ledger)
    real(wp), intent(in) :: numbers(ledger_size)
    type(ledger_t) :: ledger

    ledger = ledger_t(numbers(1), numbers(2), numbers(3), numbers(4), numbers(5), numbers(6), numbers(7), &
                      numbers(8), numbers(9), numbers(10), numbers(11), numbers(12), numbers(13), numbers(14))
  end function ledger_from

  !> What is printed at the end of every run.
  subroutine print_ledger(self, scene, lost, lost_mass, unit)
    class(ledger_t), intent(in) :: self
    type(scene_t), intent(in) :: scene
    integer(i8), intent(in) :: lost        !< parcels expected but not found
    real(wp), intent(in) :: lost_mass      !< [kg]
    integer, intent(in) :: unit

    write (unit, '(a)') 'conservation'
    if (scene%with_parcels) then
      call line('parcels', shown(scene%solids%added)//' put in, '//shown(scene%solids%left) &
        //' left through open faces, '//shown(lost)//' lost')
      call line('parcel mass', scientific(scene%solids%mass_added)//' kg put in, ' &
        //scientific(scene%solids%mass_left)//' kg left, '//scientific(lost_mass)//' kg unaccounted for')
    end if
    if (scene%with_gas) then
      call line('gas mass', scientific(self%gas_in)//' kg in, '//scientific(self%gas_out)//' kg out, ' &
        //scientific(self%gas_stored)//' kg stored, '//scientific(self%gas_in - self%gas_out - self%gas_stored) &
        //' kg unaccounted for')
      call line('', 'at worst '//scientific(self%worst_imbalance)//' of the inflow in one step (tolerance ' &
        //scientific(scene%gas%numerics%tolerance)//')')
    end if
    if (scene%with_gas .and. scene%with_parcels) then
      call line('momentum', 'gas against parcels, at worst '//scientific(self%worst_exchange)//' in one step')
      call line('void fraction', 'least '//scientific(self%least_void_fraction)//', hidden from the gas at worst ' &
        //scientific(self%worst_clipping)//' of the solids')
    end if

  contains

    subroutine line(name, words)
      character(len=*), intent(in) :: name, words

      write (unit, '(2x,a,t18,a)') name, words
    end subroutine line

  end subroutine print_ledger

  !> Three digits are enough to see how large it is.
  pure function scientific(x) result(words)
    real(wp), intent(in) :: x
    character(len=:), allocatable :: words

    character(len=16) :: buffer

    write (buffer, '(es11.3)') x
    words = trim(adjustl(buffer))
  end function scientific

end module ledger
