!> A &powder record: particles of one material with a distribution of real particle sizes.
module powder_settings
  use case_keys, only: keys_t
  use constants, only: unset, is_set
  use kinds, only: wp
  use table_settings, only: table_settings_t
  use text, only: word_length, shown
  implicit none
  private
  public :: powder_settings_t, declare_powder

  real(wp), parameter :: closure = 1.0e-3_wp  !< how far the sum of a table may be from 1

  !> `sizes` and `fractions` come from the &table record that the powder names. They are of one length, and
  !> the sizes rise:
  !> 'sieve_table'   fractions(i) = mass fraction finer than sizes(i), from 0 at the first to 1 at the last
  !> 'number_table'  fractions(i) = share of the number of particles that have sizes(i), together 1
  type :: powder_settings_t
    character(len=word_length) :: id = ''
    real(wp) :: density = unset                              !< of a particle [kg/m3]
    character(len=word_length) :: material_id = ''           !< key material
    integer :: material = 0                                  !< place of that record; 0: none, contacts as &contact says
    character(len=word_length) :: distribution = 'single'    !< or 'normal', 'log_normal', 'sieve_table', 'number_table'
    character(len=word_length) :: basis = 'number'           !< normal, log_normal: 'number' | 'mass'
    real(wp) :: mean_diameter = unset                        !< of the distribution before clipping [m]
    real(wp) :: standard_deviation = unset                   !< of the diameter before clipping [m]
    real(wp) :: minimum_diameter = unset                     !< no particle is smaller [m]
    real(wp) :: maximum_diameter = unset                     !< no particle is larger [m]
    character(len=word_length) :: table = ''                 !< id of the &table record
    real(wp), allocatable :: sizes(:)                        !< of the table [m]
    real(wp), allocatable :: fractions(:)                    !< of the table [-]
  end type powder_settings_t

contains

  !> The keys of the open record.
  subroutine declare_powder(settings, tables, keys)
    type(powder_settings_t), intent(inout) :: settings
    type(table_settings_t), intent(in) :: tables(:)  !< all &table records
    type(keys_t), intent(inout) :: keys

    integer :: table
    logical :: tabulated

    call keys%get_id(settings%id, 'name of the powder')
    call keys%get('density', settings%density, 'density of a particle [kg/m3]', '(0, inf)', required=.true., when='always')
    call keys%get_optional_reference('material', settings%material_id, settings%material, 'material', &
                                     'what its particles are made of, a &material; if not given, what &contact says')
    call keys%get('distribution', settings%distribution, 'distribution of the particle diameter', &
                  'single | normal | log_normal | sieve_table | number_table')
    tabulated = index(settings%distribution, 'table') > 0
    call keys%get('basis', settings%basis, 'normal, log_normal: whether mean and deviation count particles or mass', &
                  'number | mass')
    call keys%get('mean_diameter', settings%mean_diameter, 'mean, without limits; the diameter itself if single [m]', &
                  '(0, 1)', required=.not. tabulated, when='without a table')
    call keys%get('standard_deviation', settings%standard_deviation, 'of the diameter, without limits [m]', '(0, 1)', &
                  required=any(settings%distribution == ['normal    ', 'log_normal']), when='for normal and log_normal')
    call keys%get('minimum_diameter', settings%minimum_diameter, 'no particle is smaller; cuts, does not collect [m]', '(0, 1)')
    call keys%get('maximum_diameter', settings%maximum_diameter, 'no particle is larger; cuts, does not collect [m]', '(0, 1)')
    call keys%get_reference('table', settings%table, table, 'table', required=tabulated, &
                            when='for sieve_table and number_table')
    call check_limits(settings, keys)
    if (table == 0 .or. .not. tabulated) return
    if (.not. (allocated(tables(table)%sizes) .and. allocated(tables(table)%fractions))) return
    settings%sizes = tables(table)%sizes
    settings%fractions = tables(table)%fractions
    call check_table(settings, keys)
  end subroutine declare_powder

  !> Limits must leave something, and a mean lies between them.
  subroutine check_limits(settings, keys)
    type(powder_settings_t), intent(in) :: settings
    type(keys_t), intent(inout) :: keys

    real(wp) :: least, most

    least = 0.0_wp
    most = huge(1.0_wp)
    if (is_set(settings%minimum_diameter)) least = settings%minimum_diameter
    if (is_set(settings%maximum_diameter)) most = settings%maximum_diameter
    call keys%require(least < most, 'minimum_diameter', 'must be smaller than maximum_diameter')
    if (.not. (least < most .and. is_set(settings%mean_diameter))) return
    call keys%require(settings%mean_diameter >= least .and. settings%mean_diameter <= most, 'mean_diameter', &
                      'must lie between minimum_diameter and maximum_diameter')
  end subroutine check_limits

  !> What the numbers of a table must be for this distribution.
  subroutine check_table(settings, keys)
    type(powder_settings_t), intent(in) :: settings
    type(keys_t), intent(inout) :: keys

    integer :: n

    n = size(settings%fractions)
    if (size(settings%sizes) /= n) return
    if (settings%distribution == 'number_table') then
      call keys%require(abs(sum(settings%fractions) - 1.0_wp) <= closure, 'table', &
                        'the fractions of a number_table add up to 1, not to '//shown(sum(settings%fractions)))
    else
      call keys%require(n > 1 .and. settings%fractions(1) <= 0.0_wp .and. abs(settings%fractions(n) - 1.0_wp) <= closure &
                        .and. all(settings%fractions(2:) >= settings%fractions(:n - 1)), 'table', &
                        'the fractions of a sieve_table rise from 0 at the first size to 1 at the last')
    end if
  end subroutine check_table

end module powder_settings
